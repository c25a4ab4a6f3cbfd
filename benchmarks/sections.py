"""Poincaré sections at compiled speed: points a second, beside events met one orbit after the other, in one run.

python benchmarks/sections.py            # 10⁶ points of Hénon and Heiles
python benchmarks/sections.py --points 100000
"""

import argparse
import time

import numpy as np

from canon import Event, coordinates, propagate
from canon.flow import poincare_section, starts_of_energy

HOW = {"method": "kahan-li-8", "step": 0.2}
BY_EVENTS = 200
"""So many points are met as events, which shows what each costs."""


def starts(orbits: int) -> np.ndarray:
    """Starts on x = 0 with the energy 1/8 in the bounded part."""
    draw = np.random.default_rng(1)
    y, p = draw.uniform(-0.3, 0.5, orbits), draw.uniform(-0.25, 0.25, orbits)
    zero = np.zeros(orbits)
    return starts_of_energy("henon-heiles", 0.125, np.array([zero, y, zero, p]), "p_x")


def seconds(work) -> tuple[float, float]:
    """Wall-clock and processor time of the best of three."""
    found = []
    for _ in range(3):
        wall, cpu = time.perf_counter(), time.process_time()
        work()
        found.append((time.perf_counter() - wall, time.process_time() - cpu))
    return min(found)


def main() -> None:
    arguments = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    arguments.add_argument("--points", type=int, default=1_000_000)
    wanted = arguments.parse_args().points
    orbits, each = max(wanted // 500, 1), 500
    many, one = starts(orbits), starts(1)[:, 0]
    span = (0, 10.0 * each)
    found = poincare_section("henon-heiles", span, many, "x", points=each, **HOW)
    wall, cpu = seconds(lambda: poincare_section("henon-heiles", span, many, "x", points=each, **HOW))
    alone = (0, 6.5 * BY_EVENTS)
    events = [Event(coordinates("x"), 1)]
    met = propagate("henon-heiles", alone, one, samples=1, events=events, **HOW).events
    _, of_events = seconds(lambda: propagate("henon-heiles", alone, one, samples=1, events=events, **HOW))
    taylor = propagate("henon-heiles", alone, one, samples=1, events=events).events
    _, of_taylor = seconds(lambda: propagate("henon-heiles", alone, one, samples=1, events=events))
    own = cpu / len(found.t)
    print(
        f"{len(found.t)} points of {orbits} orbits, {found.steps / len(found.t):.0f} steps of kahan-li-8 to a point"
    )
    print(
        f"  {wall:.2f} s, {cpu:.2f} s of processor; largest |x| {abs(found['x']).max():.1e}, "
        f"largest change of H {abs(found.energy_change).max():.1e}"
    )
    print(f"  events of the same method, one orbit: {of_events / len(met) / own:.0f} times as long a point")
    print(
        f"  events of heyoka's Taylor method, one orbit: {of_taylor / len(taylor) / own:.0f} times as long a point"
    )


if __name__ == "__main__":
    main()
