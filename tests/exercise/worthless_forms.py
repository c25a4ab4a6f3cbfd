"""The forms of worthless answers: what spoils a right answer, and the same decoration done honestly."""

from dataclasses import dataclass

from tests.exercise.right_answers import Right

HIDDEN_ZEROS = {
    "polynomial": ("(U+1)**2 - U**2 - 2*U - 1", r"(U+1)^2 - U^2 - 2 U - 1"),
    "trigonometric": ("sin(U)**2 + cos(U)**2 - 1", r"\sin^2 U + \cos^2 U - 1"),
    "hyperbolic": ("cosh(U)**2 - sinh(U)**2 - 1", r"\cosh^2 U - \sinh^2 U - 1"),
    "tangent": ("tan(U) - sin(U)/cos(U)", r"\tan U - \frac{\sin U}{\cos U}"),
    "exponential": ("exp(U+V) - exp(U)*exp(V)", r"e^{U+V} - e^U e^V"),
    "radical": ("sqrt(U**4 + 2*U**2 + 1) - U**2 - 1", r"\sqrt{U^4 + 2 U^2 + 1} - U^2 - 1"),
    "modulus": ("Abs(U**2 - 1) - Abs(U - 1)*Abs(U + 1)", r"|U^2 - 1| - |U - 1|\cdot|U + 1|"),
    "parameter": ("(kappa+U)**2 - kappa**2 - 2*kappa*U - U**2", r"(\kappa+U)^2 - \kappa^2 - 2\kappa U - U^2"),
    "two variables": ("(U+V)**2 - (U-V)**2 - 4*U*V", r"(U+V)^2 - (U-V)^2 - 4 U\cdot V"),
    "logarithm": (
        "log(exp(2*U) + 2*exp(U) + 1) - 2*log(1 + exp(U))",
        r"\ln(e^{2 U} + 2 e^U + 1) - 2\ln(1 + e^U)",
    ),
    "double angle": ("cos(2*U) - 2*cos(U)**2 + 1", r"\cos(2 U) - 2\cos^2 U + 1"),
    "addition": ("sin(U+V) - sin(U)*cos(V) - cos(U)*sin(V)", r"\sin(U+V) - \sin U\cos V - \cos U\sin V"),
    "number": ("sqrt(3 + 2*sqrt(2)) - 1 - sqrt(2)", r"\sqrt{3 + 2\sqrt2} - 1 - \sqrt2"),
    "greatest": ("Max(U, V) - (U + V + Abs(U - V))/2", r"\max(U, V) - \frac{U + V + |U - V|}{2}"),
    "arcs": ("asin(tanh(U)) + acos(tanh(U)) - pi/2", r"\arcsin(\tanh U) + \arccos(\tanh U) - \frac\pi2"),
    "sign": ("U*sign(U) - Abs(U)", r"U \operatorname{sgn}(U) - |U|"),
}
"""Expressions that are zero, and do not look it."""

PLAIN_ZEROS = (
    "polynomial",
    "trigonometric",
    "hyperbolic",
    "tangent",
    "radical",
    "parameter",
    "double angle",
    "number",
)
"""Those without kinks, and of functions of one variable: what honest people add without noticing."""


@dataclass(frozen=True)
class Form:
    """What is made of a right answer R, a hidden zero Z and variables U, V: plain and, where it can be said, in LaTeX.

    ``roles`` names the answers of which it is made; none means those of its class. ``beside`` is a right one near it.
    """

    name: str
    plain: str
    latex: str = ""
    roles: tuple[str, ...] = ()
    beside: str = ""

    def written(self, right: Right, zero: str) -> tuple[str, str]:
        """Return the answer in the plain language and in LaTeX (empty where it can't be said)."""
        plain, latex = HIDDEN_ZEROS[zero]
        u, v = right.u, right.v
        said = _put(self.plain, f"({right.answer})", f"({plain})", f"({u[0]})", f"({v[0]})")
        shown = _put(self.latex, f"({right.latex})", f"({latex})", f"{{{u[1]}}}", f"{{{v[1]}}}")
        if right.frame[0] != "{}":
            said, shown = right.frame[0].format(f"({said})"), right.frame[1].format(f"({shown})")
        if "e" in right.keys.get("small", ()):  # then e^q is asked about
            shown = shown.replace("e^", r"\exp")
        return said, f"${shown}$" if self.latex else ""


def _put(form: str, right: str, zero: str, u: str, v: str) -> str:
    """Put the parts in; what was put in is not looked at again."""
    zero = zero.replace("U", "\0u").replace("V", "\0v")
    for mark, part in (("R", "\0r"), ("Z", zero), ("U", "\0u"), ("V", "\0v")):
        form = form.replace(mark, part)
    return form.replace("\0u", u).replace("\0v", v).replace("\0r", right)


ALL = ("value", "expansion", "equation", "multiplier", "condition", "constant", "motion", "potential")
"""Answers that a jump spoils; maps of phase space may jump, as angles do."""
MAPS = ("map", "implicit", "lagrangian")
SYSTEMS = ("equation", "multiplier", "condition", "implicit")
OFF_POINTS = ("value", "equation", "multiplier", "map")
"""Answers of which nothing is asked at single points: they need neither be continuous nor have an expansion."""

NOWHERE = (
    Form("seven over zero", "7/Z", r"\frac{7}{Z}", beside="R*7/(7 + Z)"),
    Form(
        "zero over zero",
        "(exp(U)*exp(-U) - 1)/Z",
        r"\frac{e^U e^{-U} - 1}{Z}",
        beside="R + Z/(exp(U)*exp(-U))",
    ),
    Form("power minus one", "Z**-1", r"Z^{-1}", beside="R*(1 + Z)**-1"),
    Form("beside the answer", "R + 7/Z", r"R + \frac{7}{Z}", beside="R + Z/7"),
    Form("times over", "R*Z/(2*Z)", r"\frac{R Z}{2 Z}", beside="R*(Z + 1 + U**2)/(1 + U**2)"),
    Form(
        "over another zero",
        "R + (sin(U)**2 + cos(U)**2 - 1)/Z",
        r"R + \frac{\sin^2 U + \cos^2 U - 1}{Z}",
        beside="R + (sin(U)**2 + cos(U)**2 - 1)/(1 + U**2)",
    ),
    Form(
        "times one over zero",
        "R*(1 + (cosh(V)**2 - sinh(V)**2 - 1)/Z)",
        r"R (1 + \frac{\cosh^2 V - \sinh^2 V - 1}{Z})",
        beside="R*(1 + (cosh(V)**2 - sinh(V)**2 - 1)/(2 + Z))",
    ),
    Form(
        "a plain zero below",
        "R + (exp(U)*exp(-U) - 1)/(U - U)",
        r"R + \frac{e^U e^{-U} - 1}{U - U}",
        beside="R + (exp(U)*exp(-U) - 1)/(U**2 + 1)",
    ),
    Form("nothing to the minus one", "R + 0*0**-1", r"R + 0\cdot 0^{-1}", beside="R + 0*1**-1"),
    Form("logarithm", "R + (U - U)*log(Z)", r"R + 0\cdot\ln Z", beside="R + (U - U)*log(1 + Z + U**2)"),
    Form(
        "logarithm less itself",
        "R + log(Z) - log(2*Z) + log(2)",
        r"R + \ln Z - \ln(2 Z) + \ln 2",
        beside="R + log(1 + U**2) - log(2 + 2*U**2) + log(2)",
    ),
    Form(
        "tangent of a right angle",
        "R + Z*tan(pi/2 + Z)",
        r"R + Z\tan(\frac\pi2 + Z)",
        beside="R + Z*tan(pi/4 + Z)",
    ),
    Form(
        "angle at the origin",
        "R + Z*atan2(Z, Z)",
        r"R + Z\operatorname{atan2}(Z, Z)",
        beside="R + Z*atan2(Z, 1 + U**2)",
    ),
    Form("cotangent of zero", "R + Z*cot(Z)", r"R + Z\cot Z", beside="R + Z*cot(1 + Z)"),
    Form(
        "artanh of one", "R + Z*atanh(1 + Z)", r"R + Z\operatorname{artanh}(1 + Z)", beside="R + Z*atanh(Z)"
    ),
    Form("root below", "R + Z/sqrt(Z)", r"R + \frac{Z}{\sqrt{Z}}", beside="R + Z/sqrt(1 + U**2)"),
    Form(
        "greatest below", "R + Z/Max(Z, -U**2)", r"R + \frac{Z}{\max(Z, -U^2)}", beside="R + Z/Max(1, U**2)"
    ),
    Form("modulus below", "R + Z/Abs(Z)", r"R + \frac{Z}{|Z|}", beside="R + Z/(1 + Abs(U))"),
    Form("fraction in a fraction", "R/(1 + 1/Z)", r"\frac{R}{1 + \frac{1}{Z}}", beside="R/(1 + Z/2)"),
    Form(
        "wave of one over zero", "R + Z*sin(1/Z)", r"R + Z\sin(\frac{1}{Z})", beside="R + Z*sin(1/(1 + U**2))"
    ),
    Form("exponential of one over zero", "R*exp(Z/Z**2)", r"R \exp(\frac{Z}{Z^2})", beside="R*exp(Z/2)"),
    Form("a small power below", "R + Z/Z**(1/3)", r"R + \frac{Z}{\sqrt[3]{Z}}", beside="R + Z/8**(1/3)"),
    Form("nothing to a negative power", "R*(1 + 0**(-1 - U**2))", beside="R*(1 + 0**(1 + U**2))"),
    Form("elliptic integral of one", "R + Z*elliptic_k(1 + Z)", beside="R + Z*elliptic_k(1/2)"),
    Form(
        "Lambert's function of no logarithm",
        "R + LambertW(log(Z)) - LambertW(log(Z/2) + log(2))",
        beside="R + Z*LambertW(1 + U**2)",
    ),
    Form("modulus of a pole", "R + Abs(1/Z) - Max(1/Z, -1/Z)", beside="R + Abs(Z)"),
    Form(
        "sign of a pole", "R*sign(1/Z)**2", r"R \operatorname{sgn}(\frac{1}{Z})^2", beside="R*sign(1 + Z**2)"
    ),
    Form(
        "piece: sine above one", "Piecewise((R, sin(U) > 1))", beside="Piecewise((R, sin(U) > 1), (R, True))"
    ),
    Form("piece: a square below zero", "Piecewise((R, U**2 < 0))", beside="Piecewise((R, U**2 >= 0))"),
    Form("piece: unlike itself", "Piecewise((R, Ne(U, U)))", beside="Piecewise((R, U == U))"),
    Form("piece: modulus below zero", "Piecewise((R, Abs(U) < 0))", beside="Piecewise((R, Abs(U) >= 0))"),
    Form(
        "piece: two at once",
        "Piecewise((R, Max(U, -U) < 0))",
        beside="Piecewise((R, Max(U, -U) < 0), (R, True))",
    ),
    Form("piece: exponential", "Piecewise((R, exp(U) < 0))", beside="Piecewise((R, exp(U) > 0))"),
    Form(
        "piece: above another",
        "Piecewise((R, U > V), (R, U < V)) + Piecewise((0, cosh(U) < 1))",
        beside="Piecewise((R, U > V), (R, U <= V))",
    ),
    Form("piece: zero is not zero", "Piecewise((R, Ne(Z, 0)))", beside="Piecewise((R, Ne(Z, 0)), (R, True))"),
)
"""No value anywhere, or wherever the right answer has one."""

ALMOST_NOWHERE = (
    Form("at one point", "Piecewise((R, U == 0))", beside="Piecewise((R, U == 0), (R, True))"),
    Form("far out", "Piecewise((R, U > 10**200))", beside="Piecewise((R, U > 10**200), (R, True))"),
    Form(
        "close to zero",
        "Piecewise((R, Abs(U) < 10**(-200)))",
        beside="Piecewise((R, Abs(U) < 10**(-200)), (R, True))",
    ),
    Form("on a grid", "Piecewise((R, sin(pi*U) == 0))", beside="Piecewise((R, sin(pi*U) == 0), (R, True))"),
    Form("where two agree", "Piecewise((R, U - V == 1))", beside="Piecewise((R, U - V == 1), (R, True))"),
    Form("not above zero and not below", "Piecewise((R, U**2 <= 0))", beside="Piecewise((R, U**2 >= 0))"),
    Form("at the crest", "Piecewise((R, sin(U) >= 1))", beside="Piecewise((R, sin(U) >= 1), (R, True))"),
    Form(
        "two points",
        "Piecewise((R, U == 1), (R, U == 2))",
        beside="Piecewise((R, U == 1), (R, U == 2), (R, True))",
    ),
    Form(
        "a strip",
        "Piecewise((R, Abs(U - 3) < 10**(-9)))",
        beside="Piecewise((R, Abs(U - 3) < 10**(-9)), (R, True))",
    ),
    Form("a half", "Piecewise((R, U > 0))", beside="Piecewise((R, U > 0), (R, U <= 0))"),
    Form("zero times a half", "R + Piecewise((0, U < 0))", beside="R + Piecewise((0, U < 0), (0, True))"),
    Form(
        "beyond a strip",
        "Piecewise((R, Abs(U) > 10**(-9)))",
        beside="Piecewise((R, Abs(U) > 10**(-9)), (R, True))",
    ),
    Form(
        "not on a far end", "Piecewise((R, U < 10**9))", beside="Piecewise((R, U < 10**9), (R, U >= 10**9))"
    ),
)
"""No value on an open part of the domain."""

JUMPS = (
    Form("sign", "R + sign(U)", r"R + \operatorname{sgn}(U)", beside="R + sign(1 + U**2) - 1"),
    Form("modulus over itself", "R + Abs(U)/U", r"R + \frac{|U|}{U}", beside="R + Abs(U)*Abs(U)/U - U"),
    Form(
        "root of a square", "R + sqrt(U**2)/U", r"R + \frac{\sqrt{U^2}}{U}", beside="R + sqrt(U**2) - Abs(U)"
    ),
    Form(
        "staircase",
        "R + U - atan(tan(pi*U))/pi",
        r"R + U - \frac{1}{\pi}\arctan(\tan(\pi U))",
        beside="R + U - tan(atan(U))",
    ),
    Form(
        "two arcs",
        "R + atan(1/U) + atan(U)",
        r"R + \arctan(\frac{1}{U}) + \arctan U",
        beside="R + atan(1/(1 + U**2)) + atan(1 + U**2) - pi/2",
    ),
    Form(
        "two logarithms",
        "R + log(U) - log(-U)",
        r"R + \ln(U) - \ln(-U)",
        beside="R + log(1 + U**2) - log(-(-1 - U**2))",
    ),
    Form(
        "half a turn", "R + atan2(0, U)", r"R + \operatorname{atan2}(0, U)", beside="R + atan2(0, 1 + U**2)"
    ),
    Form("step", "R + Piecewise((0, U < 0), (1, True))", beside="R + Piecewise((0, U < 0), (0, True))"),
    Form(
        "sign times a constant",
        "R*sign(U)",
        r"R \operatorname{sgn}(U)",
        roles=("value", "constant", "motion"),
        beside="R*sign(1 + U**2)",
    ),
    Form(
        "sign of a sine",
        "R + sign(sin(U))",
        r"R + \operatorname{sgn}(\sin U)",
        beside="R + sign(2 + U**2) - 1",
    ),
    Form(
        "arc of a cosine",
        "R + (acos(cos(U)) - asin(sin(U)))**2 - pi*(acos(cos(U)) - asin(sin(U)))/2",
        r"R + (\arccos(\cos U) - \arcsin(\sin U))^2 - \frac\pi2(\arccos(\cos U) - \arcsin(\sin U))",
        beside="R + cos(acos(tanh(U))) - tanh(U)",
    ),
    Form(
        "greatest over itself",
        "R + Max(U, 0)/(U + Abs(U) + 2*Max(-U, 0))",
        r"R + \frac{\max(U, 0)}{U + |U| + 2\max(-U, 0)}",
        beside="R + Max(U**2 + 1, 0) - U**2 - 1",
    ),
    Form(
        "a far step",
        "R + Piecewise((0, U < 10**6), (1, True))",
        beside="R + Piecewise((0, U < 10**6), (0, True))",
    ),
    Form("imaginary step", "R + I*sign(U)", beside="R + I*(sign(1 + U**2) - 1)"),
)
"""The right answer and something that is constant but for jumps."""

PARTS = (
    Form("right above zero", "Piecewise((R, U > 0), (7, True))", beside="Piecewise((R, U > 0), (R, True))"),
    Form(
        "right but far out",
        "Piecewise((R, U < 10**9), (7, True))",
        beside="Piecewise((R, U < 10**9), (R, True))",
    ),
    Form("plus the negative part", "R + U - Abs(U)", r"R + U - |U|", beside="R + U - Max(U, 0) - Min(U, 0)"),
    Form(
        "plus what is far out",
        "R + Max(U - 10**9, 0)",
        r"R + \max(U - 10^9, 0)",
        beside="R + Max(U - 10**9, 0) - (U - 10**9 + Abs(U - 10**9))/2",
    ),
    Form(
        "a bump",
        "R + Max(10**(-9) - Abs(U - 1), 0)",
        r"R + \max(10^{-9} - |U - 1|, 0)",
        beside="R + Max(-10**(-9) - Abs(U - 1), 0)",
    ),
    Form("a tenth of nothing", "R + U/10**40", r"R + \frac{U}{10^{40}}", beside="R + (U - U)/10**40"),
    Form("root less itself", "R + sqrt(U**2) - U", r"R + \sqrt{U^2} - U", beside="R + sqrt(U**2) - Abs(U)"),
    Form(
        "arc less its angle",
        "R + asin(sin(U)) - U",
        r"R + \arcsin(\sin U) - U",
        beside="R + sin(asin(tanh(U))) - tanh(U)",
    ),
    Form(
        "the cosine's arc",
        "R + acos(cos(U)) - U",
        r"R + \arccos(\cos U) - U",
        beside="R + cos(acos(tanh(U))) - tanh(U)",
    ),
    Form(
        "the tangent's arc",
        "R + atan(tan(U)) - U",
        r"R + \arctan(\tan U) - U",
        roles=ALL,
        beside="R + tan(atan(U)) - U",
    ),
    Form("complex logarithm", "R + log(exp(I*U)) - I*U", roles=ALL, beside="R + log(exp(U)) - U"),
    Form("imaginary by a hair", "R + I*U/10**40", beside="R + I*(U - U)/10**40"),
    Form("fades away", "R + exp(-U**2 - 99)", r"R + \exp(-U^2 - 99)", beside="R + exp(-U**2 - 99)*Z"),
    Form(
        "a seventh power",
        "R + sqrt(U**14) - U**7",
        r"R + \sqrt{U^{14}} - U^7",
        beside="R + sqrt(U**14) - Abs(U)**7",
    ),
)
"""Right on a part of the domain, or almost; false on an open part."""

EQUATIONS = (
    Form("nothing", "0", r"0 = 0", roles=SYSTEMS, beside="R = 0"),
    Form("a hidden zero", "Z", r"Z = 0", roles=SYSTEMS, beside="R + Z = Z"),
    Form("itself", "R = R", r"R = R", roles=SYSTEMS, beside="2*R = R"),
    Form("times a zero", "R*Z", r"R Z = 0", roles=SYSTEMS, beside="R*(1 + Z)"),
    Form(
        "over a zero",
        "R/Z",
        r"\frac{R}{Z} = 0",
        roles=("equation", "multiplier", "implicit"),
        beside="R/(1 + Z)",
    ),
    Form("times nothing but at a point", "R*(1 - sign(U)**2)", roles=SYSTEMS, beside="R*(1 + sign(U)**2)"),
    Form("times a half", "R*Max(U, 0)", r"R \max(U, 0) = 0", roles=("equation",), beside="R*Max(1, 2)"),
    Form(
        "times a far part",
        "R*Max(U - 10**9, 0)",
        r"R \max(U - 10^9, 0) = 0",
        roles=("equation",),
        beside="R*Max(2, 1)",
    ),
    Form("squared", "R**2", r"R^2 = 0", roles=("equation",), beside="2*R"),
    Form("never true", "1 = 0", r"1 = 0", roles=SYSTEMS, beside="-R = 0"),
    Form("never true, hidden", "Z = 1", r"Z = 1", roles=SYSTEMS, beside="R = Z"),
    Form("with its negative", "R = R + Z", r"R = R + Z", roles=SYSTEMS, beside="R = Z - R"),
    Form("equal powers", "R**0 = 1", r"R^0 = 1", roles=SYSTEMS, beside="R**1 = 0"),
    Form(
        "a piece of it",
        "Piecewise((R, U == 0), (0, True))",
        roles=SYSTEMS,
        beside="Piecewise((R, U == 0), (R, True))",
    ),
    Form(
        "no modulus",
        "Abs(R) = -1",
        r"|R| = -1",
        roles=("equation", "multiplier", "condition"),
        beside="2*R = 0",
    ),
    Form("imaginary", "I*R + 1", roles=("value", "equation", "multiplier", "motion"), beside="R + I*(U - U)"),
)
"""Equations that everything satisfies, or nothing does."""

HONEST = (
    Form("nothing added", "R + 0", r"R + 0"),
    Form("a hidden zero added", "R + Z", r"R + Z"),
    Form("a hidden zero over something", "R + Z/(1 + U**2)", r"R + \frac{Z}{1 + U^2}"),
    Form("a hidden zero over one and itself", "R + Z/(1 + Z)", r"R + \frac{Z}{1 + Z}"),
    Form("a factor that cancels", "R*(U**2 - 1)/(U - 1)/(U + 1)", r"\frac{R (U^2 - 1)}{(U - 1)(U + 1)}"),
    Form("squares of sine and cosine", "R*(sin(U)**2 + cos(U)**2)", r"R (\sin^2 U + \cos^2 U)"),
    Form("all pieces", "Piecewise((R, U > 0), (R, True))"),
    Form("pieces that meet", "Piecewise((R, U > 0), (R, U <= 0))"),
    Form("all but a point", "Piecewise((R, Ne(U, 0)), (7, True))", roles=OFF_POINTS),
    Form("not at a point", "Piecewise((R, Ne(U, 0)))", roles=OFF_POINTS),
    Form("a modulus and its root", "R + Abs(U) - sqrt(U**2)", r"R + |U| - \sqrt{U^2}"),
    Form("modulus times sign", "R + Abs(U)*sign(U) - U", r"R + |U|\operatorname{sgn}(U) - U"),
    Form("times the square of a sign", "R*sign(U)**2", r"R \operatorname{sgn}(U)^2", roles=OFF_POINTS),
    Form(
        "logarithms",
        "R + log(U**2) - 2*log(Abs(U))",
        r"R + \ln(U^2) - 2\ln|U|",
        roles=("value", "equation", "multiplier", "constant", "map"),
    ),
    Form("exponentials", "R*exp(U)*exp(-U)", r"R e^U e^{-U}"),
    Form("an honest denominator", "R*(Z + 1 + U**2)/(1 + U**2)", r"\frac{R (Z + 1 + U^2)}{1 + U^2}"),
    Form("a fraction in a fraction", "R/(1 + Z/(1 + U**2))", r"\frac{R}{1 + \frac{Z}{1 + U^2}}"),
    Form("tangent", "R + Z*tan(U)", r"R + Z\tan U"),
    Form("arc of a tangent", "R + tan(atan(U)) - U", r"R + \tan(\arctan U) - U"),
    Form(
        "greatest",
        "R + Max(U, -U) - Abs(U)",
        r"R + \max(U, -U) - |U|",
        roles=("value", "equation", "multiplier", "constant", "potential", "map"),
    ),
    Form("wrong at an instant only", "R + 1 - sign(U)**2", roles=OFF_POINTS),
    Form("wave", "R + Z*sin(1/(1 + U**2))", r"R + Z\sin(\frac{1}{1 + U^2})"),
)
"""The right answer in other clothes: it still holds."""

CLASSES = {
    "nowhere": (
        NOWHERE,
        (*ALL, *MAPS, "number", "constraint", "rational", "open", "not constant", "parameter"),
    ),
    "almost nowhere": (ALMOST_NOWHERE, (*ALL, *MAPS, "number")),
    "jumps": (JUMPS, (*ALL, "number", "parameter")),
    "parts": (PARTS, (*ALL, *MAPS, "number", "parameter")),
    "equations": (EQUATIONS, SYSTEMS),
    "honest": (HONEST, tuple({*ALL, *MAPS, "open", "not constant", "parameter"} - {"condition", "implicit"})),
}
"""The forms of each class, and of which answers they are made."""
