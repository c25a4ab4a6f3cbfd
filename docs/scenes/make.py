"""Write docs/scenes.md and its pictures: every scene with its equations, integrals and measured drift.

python docs/scenes/make.py            # all of it, about two minutes
python docs/scenes/make.py kepler     # the pictures of some scenes only

Some scenes are shown in motion too, four seconds long; the page loads an animation when it is asked for.
"""

from __future__ import annotations

import sys
from pathlib import Path
from typing import TYPE_CHECKING

sys.path.insert(0, str(Path(__file__).resolve().parents[2]))

from canon.plot.scene import animate_scene, plot_scene
from canon.scene import SCENES
from canon.scene.describe import description
from canon.scene.known_truths import check, conserved
from canon.scene.scene_motion import run

if TYPE_CHECKING:
    from canon.scene.known_truths import Check
    from canon.scene.scene import Scene

HERE = Path(__file__).resolve().parent
PAGE = HERE.parent / "scenes.md"
LONGEST = 700
"""Formulas whose LaTeX is longer are left to ``canon scene NAME --latex --all``."""
MANY = 6
PERIODS = 1000.0
IN_MOTION = {
    "simple-pendulum": 1.0, "spring-pendulum": 4.0, "spherical-pendulum": 4.0, "double-pendulum": 3.0,
    "swinging-atwood": 3.0, "cart-pendulum": 3.0, "sliding-mass-pendulum": 3.0, "bead-hoop": 2.0, "piston-engine": 2.0,
    "kepler": 1.0, "figure-eight": 1.0, "restricted-three-body": 1.0, "henon-heiles": 6.0,
}  # fmt: skip
"""Scenes that are shown in motion, and for how many periods."""
MOVING_SIZE = (320, 256)
COLOURS_KEPT = 16
"""Colours of an animation: lines on white need no more."""
PROOFS_LEFT_OUT = {"outer-solar-system"}
"""Proofs of minutes; tests/scene has them."""

HEAD = """\
# Scenes

Written by `python docs/scenes/make.py`; every number below was measured by it. `canon scene` lists the scenes,
`canon scene NAME` shows one, `--run` repeats the measurements, `--plot` and `--animate` draw it.

A scene carries parameters with units and real values, named starts, how it moves, and what is known of it. Runs are
{periods:g} periods long (fewer where the scene's horizon is nearer), with heyoka's Taylor method at the tolerance of
round-off on (q, p), from every start. *Drift* is the largest relative change met; where an integral is nearly zero it
is relative to its largest term. Driven and damped scenes hold their energy against the work done. *Proof* is the
symbolic verdict on dI/dt = 0 by the equations of motion.

| scene | known motions met | integrals | largest drift | |
|---|---|---|---|---|
"""


def main(names: list[str]) -> None:
    for scene in SCENES:
        if not names or scene.name in names:
            draw(scene)
    if names:
        return
    rows, sections = [], []
    for scene in SCENES:
        print(scene.name, flush=True)
        checks = check(scene, periods=PERIODS)
        rows.append(row(scene, checks))
        sections.append(section(scene, checks))
    PAGE.write_text(HEAD.format(periods=PERIODS) + "\n".join(rows) + "\n\n" + "\n\n".join(sections) + "\n")


def draw(scene: Scene) -> None:
    periods = min(scene.shown, scene.horizon)
    axes = plot_scene(run(scene, periods=periods, samples=max(400, min(4000, round(200 * periods)))))
    figure = axes.get_figure(root=True)
    axes.set_title("")
    figure.set_size_inches(4.0, 3.2)
    figure.savefig(HERE / f"{scene.name}.png", dpi=75)

    if scene.name in IN_MOTION:
        set_in_motion(scene)


def set_in_motion(scene: Scene) -> None:
    """Write the animation of a scene, in few colours."""
    from PIL import Image, ImageSequence

    file = HERE / f"{scene.name}.gif"
    animate_scene(run(scene, periods=IN_MOTION[scene.name], samples=600), file, seconds=4.0, rate=12)
    with Image.open(file) as whole:
        frames = [
            frame.convert("RGB").resize(MOVING_SIZE).quantize(COLOURS_KEPT)
            for frame in ImageSequence.Iterator(whole)
        ]
    frames[0].save(file, save_all=True, append_images=frames[1:], duration=1000 // 12, loop=0, optimize=True)


def moving(scene: Scene) -> list[str]:
    """Return the animation of a scene behind a word to open, so that nothing moves unasked."""
    if scene.name not in IN_MOTION:
        return []
    picture = f"![{scene.name} in motion](scenes/{scene.name}.gif)"
    return ["<details><summary>in motion</summary>", "", picture, "", "</details>", ""]


def row(scene: Scene, checks: tuple[Check, ...]) -> str:
    along, met = split(scene, checks)
    worst = max(each.error for each in along)
    known = f"{sum(each.passed for each in met)} of {len(met)}" if met else "–"
    verdict = "all within bounds" if all(each.passed for each in checks) else "**a bound exceeded**"
    integrals = 1 + len(scene.integrals)
    return f"| [{scene.name}](#{scene.name}) | {known} | {integrals} | {worst:.0e} | {verdict} |"


def split(scene: Scene, checks: tuple[Check, ...]) -> tuple[list[Check], list[Check]]:
    known = {solution.name for solution in scene.solutions}
    return [c for c in checks if c.name not in known], [c for c in checks if c.name in known]


def section(scene: Scene, checks: tuple[Check, ...]) -> str:
    lines = [f"## {scene.name}", "", f"{scene.title}.", "", f"![{scene.name}](scenes/{scene.name}.png)", ""]
    lines += moving(scene)
    if scene.parameters:
        lines += ["| parameter | value | |", "|---|---|---|"]
        lines += [
            f"| {c.name} | {f'{c.value:.6g} {c.unit}'.strip()} | {c.meaning} |" for c in scene.parameters
        ]
        lines.append("")
    lines += [f"Starts: {'; '.join(f'*{s.name}*, {s.about}' for s in scene.starts)}.", ""]
    for part in description(scene):
        if part.title.startswith("Constants"):
            continue
        lines += [f"**{part.title}**{': ' + part.remark if part.remark else ''}", ""]
        for formula in part.formulas[:MANY]:
            lines += math(formula.latex)
        if len(part.formulas) > MANY:
            lines += [f"… and {len(part.formulas) - MANY} more.", ""]
    along, met = split(scene, checks)
    lines += ["| kept along the run | start and length | drift | bound | proof |", "|---|---|---|---|---|"]
    proofs = {} if scene.name in PROOFS_LEFT_OUT else {i.name: conserved(scene, i) for i in scene.integrals}
    for each in along:
        proof = proofs[each.name].status.name if each.name in proofs else ""
        why = f" ({each.why})" if each.why else ""
        lines.append(f"| {each.name} | {each.about} | {each.error:.1e} | {each.bound:.0e}{why} | {proof} |")
    if met:
        lines += ["", "| known motion | start and length | error | bound |", "|---|---|---|---|"]
        lines += [f"| {c.name} | {c.about} | {c.error:.1e} | {c.bound:.0e} |" for c in met]
    return "\n".join([*lines, "", f"Source: {scene.source}."])


def math(latex: str) -> list[str]:
    if len(latex) > LONGEST:
        return [f"(a formula of {len(latex)} characters: `canon scene NAME --latex --all` shows it)", ""]
    return [f"$${latex}$$", ""]


if __name__ == "__main__":
    main(sys.argv[1:])
