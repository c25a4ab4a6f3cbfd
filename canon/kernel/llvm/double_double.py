"""Double-double arithmetic as LLVM functions: a number is the unevaluated sum of two doubles, 106 bits.

Values have the type ``{ T, T }`` with T a double or SIMD lanes of doubles.

Source: M. Joldes, J.-M. Muller, V. Popescu, Tight and rigorous error bounds for basic building blocks of
double-word arithmetic, ACM Trans. Math. Softw. 44 (2017) 15res, doi:10.1145/3121432 (relative errors below 3u², 5u²
and 10u² for sums, products and quotients, u = 2⁻⁵³); the square root is that of V. Lefèvre, N. Louvet, J.-M. Muller,
J. Picot, L. Rideau, Accurate calculation of Euclidean norms using double-word arithmetic, ACM Trans. Math.
Softw. 49 (2023) 1, doi:10.1145/3568672.
"""

from __future__ import annotations

__all__ = ["pair_functions"]

_FUNCTIONS = {
    # AccurateDWPlusDW
    "add": """
  sh = xh + yh
  t = sh - xh
  t1 = sh - t
  t2 = xh - t1
  t3 = yh - t
  sl = t2 + t3
  th = xl + yl
  r = th - xl
  r1 = th - r
  r2 = xl - r1
  r3 = yl - r
  tl = r2 + r3
  c = sl + th
  vh = sh + c
  v1 = vh - sh
  vl = c - v1
  w = tl + vl
  zh = vh + w
  z1 = zh - vh
  zl = w - z1
""",
    # DWTimesDW3
    "mul": """
  ch = xh * yh
  nch = neg ch
  c1 = fma xh yh nch
  t0 = xl * yl
  t1 = fma xh yl t0
  c2 = fma xl yh t1
  c3 = c1 + c2
  zh = ch + c3
  z1 = zh - ch
  zl = c3 - z1
""",
    # DWDivDW2 with DWTimesFP3
    "div": """
  th = xh / yh
  ch = yh * th
  nch = neg ch
  c1 = fma yh th nch
  c3 = fma yl th c1
  rh = ch + c3
  r1 = rh - ch
  rl = c3 - r1
  ph = xh - rh
  dl = xl - rl
  d = ph + dl
  tl = d / yh
  zh = th + tl
  z1 = zh - th
  zl = tl - z1
""",
    "sqrt": """
  sh = sqrt xh
  nsh = neg sh
  p1 = fma nsh sh xh
  p2 = xl + p1
  s2 = sh + sh
  q = p2 / s2
  zero = sh == 0
  sl = zero ? sh : q
  zh = sh + sl
  z1 = zh - sh
  zl = sl - z1
""",
}
_ALGEBRA = {"+": "fadd", "-": "fsub", "*": "fmul", "/": "fdiv"}


def pair_functions(base: str, intrinsic: str, flags: str, *, inlined: bool = True) -> list[str]:
    """Return the definitions of ``@pair.add.f64``, ``mul``, ``div`` and ``sqrt`` and the declarations they need.

    Parameters
    ----------
    base
        The LLVM type T: double or lanes of doubles.
    intrinsic
        How intrinsics name it.
    flags
        The type of a comparison's result.
    inlined
        Whether they become part of what calls them: right in a loop, but long to compile where they are many.
    """
    return [
        f"declare {base} @llvm.fma.{intrinsic}({base}, {base}, {base})",
        f"declare {base} @llvm.sqrt.{intrinsic}({base})",
        *(_definition(name, base, intrinsic, flags, inlined=inlined) for name in _FUNCTIONS),
    ]


def _definition(name: str, base: str, intrinsic: str, flags: str, *, inlined: bool) -> str:
    kind = f"{{ {base}, {base} }}"
    operands = ["x"] if name == "sqrt" else ["x", "y"]
    arguments = ", ".join(f"{kind} %{x}" for x in operands)
    inlining = "alwaysinline" if inlined else "noinline"
    lines = [f"define internal {kind} @pair.{name}.{intrinsic}({arguments}) {inlining} {{"]
    for x in operands:
        lines += [f"  %{x}{part} = extractvalue {kind} %{x}, {i}" for i, part in enumerate("hl")]
    for statement in _FUNCTIONS[name].strip().splitlines():
        target, expression = statement.strip().split(" = ", 1)
        lines.append(f"  %{target} = {_instruction(expression.split(), base, intrinsic, flags)}")
    lines += [
        f"  %high = insertvalue {kind} poison, {base} %zh, 0",
        f"  %both = insertvalue {kind} %high, {base} %zl, 1",
        f"  ret {kind} %both",
        "}",
    ]
    return "\n".join(lines)


def _instruction(words: list[str], base: str, intrinsic: str, flags: str) -> str:
    if words[0] in ("fma", "sqrt"):
        return f"call {base} @llvm.{words[0]}.{intrinsic}({', '.join(f'{base} %{x}' for x in words[1:])})"
    if words[0] == "neg":
        return f"fneg {base} %{words[1]}"
    if words[1] == "==":
        return f"fcmp oeq {base} %{words[0]}, zeroinitializer"
    if words[1] == "?":
        return f"select {flags} %{words[0]}, {base} %{words[2]}, {base} %{words[4]}"
    return f"{_ALGEBRA[words[1]]} {base} %{words[0]}, %{words[2]}"
