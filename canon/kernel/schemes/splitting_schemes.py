"""Splitting methods as data: coefficients, order, and the paper each comes from.

A method is drift a₁, kick b₁, drift a₂, …, kick b_s, drift a_{s+1}, all times h. Published
coefficients carry 15 to 26 digits; the digits here were continued to 55 by Newton's method on the order
conditions, moving the published point as little as possible (``benchmarks/polish_schemes.py``), and the test
suite verifies the conditions to 50 digits (:mod:`canon.kernel.schemes.order_conditions`).
"""

from __future__ import annotations

import itertools
from dataclasses import dataclass
from fractions import Fraction
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Sequence

__all__ = ["SCHEMES", "Scheme", "palindrome"]


@dataclass(frozen=True)
class Scheme:
    """Coefficients of a symmetric splitting method, and its source.

    Parameters
    ----------
    name
        What users call it.
    order
        Its order.
    a, b
        Drift and kick coefficients, exact decimal numbers; ``len(a) == len(b) + 1``.
    citation
        Where it was published.
    nystrom
        The order holds only for kinetic energies quadratic in p with constant coefficients.
    commutators
        For each kick the weight γ of a commutator in it: by τ b V + γ τ³ {V, {T, V}} in place of τ b V. Empty where
        there is none.
    """

    name: str
    order: int
    a: tuple[Fraction, ...]
    b: tuple[Fraction, ...]
    citation: str
    nystrom: bool = False
    commutators: tuple[Fraction, ...] = ()

    def __hash__(self) -> int:
        """Return a hash that takes no time: of the name, which coefficients of one's own lack, and two numbers."""
        return hash((self.name, self.order, len(self.b)))

    @property
    def stages(self) -> int:
        """Force evaluations in a step; where it ends with a kick, its last is the next step's first."""
        return len(self.b) - int(self.kick_first)

    @property
    def kick_first(self) -> bool:
        """Whether steps start and end with a kick: the last force serves the next step's first kick too."""
        return len(self.b) > 1 and self.a[0] == self.a[-1] == 0


def palindrome(
    name: str,
    order: int,
    a: Sequence[str],
    b: Sequence[str],
    citation: str,
    *,
    odd: str,
    nystrom: bool = False,
) -> Scheme:
    """Complete a left-right symmetric method from its first half.

    The middle coefficients follow from Σa = Σb = 1; ``odd`` says which of ``"a"`` and ``"b"`` has one alone.
    """
    first = {"a": [Fraction(x) for x in a], "b": [Fraction(x) for x in b]}
    whole = dict[str, tuple[Fraction, ...]]()
    for letter, half in first.items():
        missing = 1 - 2 * sum(half, Fraction(0))
        middle = (missing,) if letter == odd else (missing / 2, missing / 2)
        whole[letter] = (*half, *middle, *reversed(half))
    return Scheme(name, order, whole["a"], whole["b"], citation, nystrom)


def _composition(name: str, order: int, weights: Sequence[str], citation: str) -> Scheme:
    """Compose Verlet steps of lengths w₁h, w₂h, …; given are the weights before the middle one."""
    half = [Fraction(w) for w in weights]
    w = [*half, 1 - 2 * sum(half, Fraction(0)), *reversed(half)]
    inner = [(x + y) / 2 for x, y in itertools.pairwise(w)]
    return Scheme(name, order, (w[0] / 2, *inner, w[-1] / 2), tuple(w), citation)


_BLANES_MOAN = (
    "S. Blanes, P. C. Moan, Practical symplectic partitioned Runge–Kutta and Runge–Kutta–Nyström methods, "
    "J. Comput. Appl. Math. 142 (2002) 313–330, doi:10.1016/S0377-0427(01)00492-7"
)
_KAHAN_LI = (
    "W. Kahan, R.-C. Li, Composition constants for raising the orders of unconventional schemes for ordinary "
    "differential equations, Math. Comp. 66 (1997) 1089–1099, doi:10.1090/S0025-5718-97-00873-9"
)

_ALL = (
    _composition(
        "verlet",
        2,
        (),
        "L. Verlet, Computer “experiments” on classical fluids, Phys. Rev. 159 (1967) 98–103, "
        "doi:10.1103/PhysRev.159.98",
    ),
    _composition(
        "forest-ruth",
        4,
        ("1.3512071919596576340476878089714608269219993762171448283",),
        "E. Forest, R. D. Ruth, Fourth-order symplectic integration, Physica D 43 (1990) 105–117, "
        "doi:10.1016/0167-2789(90)90019-L",
    ),
    _composition(
        "suzuki-4",
        4,
        (
            "0.4144907717943757371423540628607614957117746040167071333",
            "0.4144907717943757371423540628607614957117746040167071333",
        ),
        "M. Suzuki, Fractal decomposition of exponential operators, Phys. Lett. A 146 (1990) 319–323, "
        "doi:10.1016/0375-9601(90)90962-N",
    ),
    palindrome(
        "mclachlan-4",
        4,
        # (14 − √19)/108 and (20 − 7√19)/108
        (
            "0.0892694542264752448866946112605591142672499636552551395",
            "-0.0973360426368955080153599433983084223514724766354362459",
        ),
        ("2/5", "-1/10"),
        "R. I. McLachlan, On the numerical integration of ordinary differential equations by symmetric composition "
        "methods, SIAM J. Sci. Comput. 16 (1995) 151–168, doi:10.1137/0916010",
        odd="b",
    ),
    palindrome(
        "blanes-moan-4",
        4,
        (
            "0.0792036964311956694336634958882688733080195574519094104",
            "0.3531729060497739884810613115731210565303708731541754491",
            "-0.0420650803577195353681102983025170387204097163819649858",
        ),
        (
            "0.2095151066133620212740726400295010169021382161697796617",
            "-0.1438517731798180082751150578565277256482384710596567309",
        ),
        _BLANES_MOAN + " (S6)",
        odd="a",
    ),
    palindrome(
        "blanes-moan-6",
        6,
        (
            "0.0502627644003926860212216544020741094060127488325875126",
            "0.4135143004283438150630637201338844389752694164487884568",
            "0.0450798897943980629688970521245134711617180221893740279",
            "-0.1880548538195689147991284889188705424878188720111076988",
            "0.5419606784507801348314147409330724963481727633357899757",
        ),
        (
            "0.1488164479010432319209010055355775888773967192652568101",
            "-0.1323858657677836474488454265989399215744893094241303634",
            "0.0673076046921844581502578965926010468993631441993461469",
            "0.4326664025781735975276679708835452980581839414143039889",
        ),
        _BLANES_MOAN + " (S10)",
        odd="a",
    ),
    palindrome(
        "srkn-6b",
        6,
        (
            "0",
            "0.1232297759462711515610863803333667525905249350663240022",
            "0.2905537977995582703664141693279161833302101254937649368",
            "-0.1270492126254169156625050538274859344730197479093743642",
            "-0.2463317610620754041949734891040628625960106282877367616",
            "0.3572088727959277526198603496193104628368893714632504706",
        ),
        (
            "0.0414649985182628432987781339147049367239361759433449611",
            "0.1981286719180665411367264731814969606125352163678792476",
            "-0.0400061921041526868888283635359448393756941777609941673",
            "0.0752539843015803411278788785270427555417512084282378356",
            "-0.0115113874206877700624432015012891995525926378100782032",
        ),
        _BLANES_MOAN + " (SRKN 11 b)",
        odd="a",
        nystrom=True,
    ),
    palindrome(
        "srkn-6a",
        6,
        (
            "0.0378593198406136316450336367796762159694225304712285757",
            "0.1026356331024336528993679671454742408796777885043627699",
            "-0.0258678882665616788327584233868767328788275676449193337",
            "0.3142414030714704821023462456224006702351893749190591155",
            "-0.1301444595174205614989966873908269091962267801518199891",
            "0.1064177003695382965052667120325138162463549328125178776",
            "-0.0087942431285085769720769609413056302070281336494102628",
        ),
        (
            "0.0917191526244626657403751764492576852171358211285160336",
            "0.1839831700050085824742734142102382599905904672595782135",
            "-0.0565343658328841413404115595399293985574950314584764040",
            "0.0049146887747104700651490696097310742947719281354716738",
            "0.1437611271683675039172973937630912544454400677968424856",
            "0.3285676937468042715155762708859530349572313397492470368",
        ),
        _BLANES_MOAN + " (SRKN 14 a)",
        odd="a",
        nystrom=True,
    ),
    _composition(
        "kahan-li-6",
        6,
        (
            "0.3921614440073141392792505574226714038049342607577624190",
            "0.3325991367893594385997486375000496468815869445041590283",
            "-0.7062461725576393598099648195492564593955106668218681520",
            "0.0822135962935508002314904481020563311032938912326594971",
        ),
        _KAHAN_LI + " (s9odr6a)",
    ),
    _composition(
        "kahan-li-8",
        8,
        (
            "0.1302024830888900808788176320967005223572472338115395783",
            "0.5611629817751083845619644077001505672661593543409691457",
            "-0.3894749626448472864080785982352483888360680467640618975",
            "0.1588419065551556008962107457071524814121478094326365215",
            "-0.3959038941332375773362315393479389360267714854327251534",
            "0.1845396409783157070918325415333754628189873441529615494",
            "0.2583743876863220472939791099949394718130762089546281289",
            "0.2950117236093102988709662402182281129765432303464965505",
        ),
        _KAHAN_LI + " (s17odr8a)",
    ),
    _composition(
        "sofroniou-spaletta-10",
        10,
        (
            "0.0787957225216864192639076793383782352877652886006535765",
            "0.3130961034151085277648124719193751194277884550984594324",
            "0.0279183832350780661095202732646229631648935166642775544",
            "-0.2295928415939070941512133968017723337596186730086421028",
            "0.1309620610771648631746568592939396359129934481568963145",
            "-0.2697334056545107143446097322163177920891508386151396167",
            "0.0749733431558914356661371056387287990291454230198609647",
            "0.1119934239998102048895750807373869173842814953527912771",
            "0.3661334495462267511931481235379478059390051517559793138",
            "-0.3991056301360358978786298105841019696538982742174918289",
            "0.1030873985274710773158027699917783822741617109664383276",
            "0.4114308739558902378207041189776761633716690276460301027",
            "-0.0048663605831352617621956593074254758709646187813126699",
            "-0.3920333537086399064480819364305298647619236163834188843",
            "0.0519425029624496470371829049273376385168947546190480273",
            "0.0506650907599244963358743424008435193510213308675118729",
            "0.0496743706397298790545688003948408097700571104346345506",
        ),
        "M. Sofroniou, G. Spaletta, Derivation of symmetric composition constants for symmetric integrators, "
        "Optim. Methods Softw. 20 (2005) 597–613, doi:10.1080/10556780500140664",
    ),
)

SCHEMES = {scheme.name: scheme for scheme in _ALL}
"""Every splitting method by its name."""
