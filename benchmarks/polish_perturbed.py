"""Continue the published coefficients of schemes for H = A + εB to 55 digits, as ``polish_schemes.py`` does for others.

A scheme of orders (n₁, n₂, n₃) fulfils the conditions of words with one B up to length n₁, with two up to n₂, with
three and more up to n₃. Prints the largest difference from the table in ``canon/kernel/schemes/perturbed_schemes.py``.
"""

from __future__ import annotations

import sys
from typing import TYPE_CHECKING

import mpmath
import numpy as np
from mpmath import mp, mpf
from polish_schemes import WORKING_DIGITS, shortest_step, slopes

from canon.kernel.schemes.order_conditions import conditions
from canon.kernel.schemes.perturbed_schemes import ABA

if TYPE_CHECKING:
    from collections.abc import Sequence

PUBLISHED = {
    "8-6-4": (
        3,
        (
            "0.0711334264982231177779387300061549964174 0.241153427956640098736487795326289649618 "
            "0.521411761772814789212136078067994229991 0.183083687472197221961703757166430291072 "
            "0.310782859898574869507522291054262796375 -0.0265646185119588006972121379164987592663"
        ),
    ),
    "10-6-4": (
        4,
        (
            "0.03809449742241219545697532230863756534060 0.1452987161169137492940200726606637497442 "
            "0.2076276957255412507162056113249882065158 0.4359097036515261592231548624010651844006 "
            "0.09585888083707521061077150377145884776921 0.2044461531429987806805077839164344779763 "
            "0.2170703479789911017143385924306336714532"
        ),
    ),
}


def complete(x: Sequence[mpf], drifts: int) -> tuple[list[mpf], list[mpf]]:
    """Complete the halves to symmetric coefficients that add up to 1."""
    whole = []
    for half, odd in ((list(x[:drifts]), drifts == 4), (list(x[drifts:]), drifts == 3)):
        missing = 1 - 2 * sum(half)
        middle = [missing] if odd else [missing / 2] * 2
        whole.append([*half, *middle, *reversed(half)])
    return whole[0], whole[1]


def polished(name: str) -> list[mpf]:
    """Return the coefficients that fulfil the conditions next to the published ones."""
    orders = [int(n) for n in name.split("-")]
    drifts, digits = PUBLISHED[name]
    powers = [np.array([word.bit_count() for word in range(2**d)]) for d in range(1, orders[0] + 1)]

    def residual(x: Sequence[mpf]) -> np.ndarray:
        found = conditions(*complete(x, drifts), orders[0])
        limits = (0, *orders, *[orders[2]] * orders[0])
        kept = [
            words[[d <= limits[k] or d == 1 for k in count]]
            for d, (words, count) in enumerate(zip(found, powers, strict=True), start=1)
        ]
        return np.concatenate(kept)

    x = np.array([mpf(text) for text in digits.split()])
    for _ in range(6):
        r = residual(x)
        if max(abs(r)) < mpf(10) ** -(WORKING_DIGITS - 60):
            break
        x = x - shortest_step(slopes(residual, x, r), r)
    a, b = complete(x, drifts)
    return [*a, *b]


def main() -> int:
    """Compare the table with the polished coefficients."""
    mp.dps = WORKING_DIGITS
    worst = mpf(0)
    for name, scheme in ABA.items():
        table = [mpf(c.numerator) / c.denominator for c in (*scheme.a, *scheme.b)]
        worst = max(worst, *(abs(x - y) for x, y in zip(polished(name), table, strict=True)))
    print(f"largest difference from the table: {mpmath.nstr(worst, 2)}")
    return int(worst > mpf(10) ** -53)


if __name__ == "__main__":
    sys.exit(main())
