"""The sections of docs/measured.md: what follows from a benchmark, its numbers as tables and a plot, its output folded.

Tables are read from what a script printed, row by row, so that nothing stands in one that was not measured.
"""

from __future__ import annotations

import re
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Callable

Rows = list[tuple[str, ...]]
Line = list[tuple[float, float]]
FIGURES = Path(__file__).parents[1] / "docs" / "figures"
FOLDED = "<details>\n<summary>{summary}</summary>\n\n```text\n{printed}\n```\n\n</details>\n"


@dataclass(frozen=True)
class Table:
    """A table: its columns, and the pattern of the lines that are its rows, one group a column.

    Lines that match ``under`` give a first cell to the rows below them.
    """

    columns: tuple[str, ...]
    row: str
    under: str = ""

    def rows(self, printed: str) -> Rows:
        """Return the cells of all rows in what was printed."""
        found: Rows = []
        head: tuple[str, ...] = ()
        for line in printed.splitlines():
            above = re.search(self.under, line) if self.under else None
            head = above.groups() if above else head
            cells = re.search(self.row, line)
            if cells and (head or not self.under):
                found.append((*head, *((cell or "").strip() for cell in cells.groups())))
        return found

    def markdown(self, printed: str) -> str:
        """Return the table as Markdown; nothing where no line is a row."""
        rows = self.rows(printed)
        if not rows:
            return ""
        lines = [self.columns, ("---",) * len(self.columns), *rows]
        return (
            "".join(f"| {' | '.join(cell.replace('|', '¦') for cell in line)} |\n" for line in lines) + "\n"
        )


def pyplot() -> Any:
    """Return matplotlib's pyplot, which opens no window."""
    import matplotlib as mpl

    mpl.use("Agg")
    import matplotlib.pyplot as plt

    return plt


def shown(figure: Any, name: str, caption: str) -> str:
    """Save a figure into docs/figures, and return the line of Markdown that shows it."""
    figure.savefig(FIGURES / f"measured_{name}.png", dpi=120, metadata={"Software": None})
    pyplot().close(figure)
    return f"![{caption}](figures/measured_{name}.png)\n\n"


@dataclass(frozen=True)
class Plot:
    """A figure from one table: two of its columns, as a line over logarithmic axes or as bars with their names."""

    table: int
    x: int
    y: int
    caption: str
    bars: bool = False

    def draw(self, tables: tuple[Table, ...], printed: str, name: str) -> str:
        """Draw into docs/figures, and return the line of Markdown that shows it."""
        plt = pyplot()
        table = tables[self.table]
        rows = table.rows(printed)
        values = [float(re.sub(r"[^\d.e+-]", "", row[self.y])) for row in rows]
        height = 0.6 + 0.24 * len(rows) if self.bars else 3.2
        figure, axes = plt.subplots(figsize=(7.0, height), layout="constrained")
        if self.bars:
            names = [", ".join(row[: self.y]) if self.x < 0 else row[self.x] for row in rows]
            axes.barh(range(len(rows)), values, color="#0072b2")
            axes.set_yticks(range(len(rows)), names, fontsize="small")
            axes.invert_yaxis()
        else:
            axes.loglog([float(row[self.x]) for row in rows], values, "o-", color="#0072b2")
            axes.set_ylabel(table.columns[self.y])
        axes.set_xlabel(table.columns[self.y if self.bars else self.x])
        axes.spines[["top", "right"]].set_visible(False)
        return shown(figure, name, self.caption)


@dataclass(frozen=True)
class Lines:
    """A figure of several lines over logarithmic axes, or of marks alone beside the line where x and y are equal.

    ``lines`` makes them, by their names, of the rows of all tables; they are shared out among the panels.
    """

    lines: Callable[[list[Rows]], dict[str, Line]]
    x: str
    y: str
    caption: str
    panels: int = 1
    equal: str = ""

    def draw(self, tables: tuple[Table, ...], printed: str, name: str) -> str:
        """Draw into docs/figures, and return the line of Markdown that shows it."""
        plt = pyplot()
        from canon.plot.style import COLOURS, GREY, LINES, MARKERS

        lines = list(self.lines([table.rows(printed) for table in tables]).items())
        each = -(-len(lines) // self.panels)
        figure, panels = plt.subplots(
            1, self.panels, figsize=(7.0, 4.8), layout="constrained", sharey=True, squeeze=False
        )
        for k, axes in enumerate(panels.flat):
            for i, (label, points) in enumerate(lines[each * k : each * (k + 1)]):
                again, colour = divmod(i, len(COLOURS))
                look = {"color": COLOURS[colour], "marker": MARKERS[colour], "ms": 5}
                drawn = "" if self.equal else LINES[again]
                axes.loglog(*zip(*points, strict=True), ls=drawn, label=label, **look)
            if self.equal:
                ends = axes.get_xlim()
                axes.loglog(ends, ends, "--", color=GREY, label=self.equal, zorder=0)
            axes.set_xlabel(self.x)
            axes.spines[["top", "right"]].set_visible(False)
            axes.legend(loc="upper center", bbox_to_anchor=(0.5, -0.16), frameon=False, fontsize="small")
        panels[0, 0].set_ylabel(self.y)
        return shown(figure, name, self.caption)


def numbers(cell: str) -> list[float]:
    return [float(word.replace(",", "")) for word in cell.split()]


def seconds_by_size(tables: list[Rows]) -> dict[str, Line]:
    """Return how long each kind of thing took, by its sizes; less than the least that is printed is left out."""
    sizes = dict(tables[1])
    return {
        what: [
            (size, took) for size, took in zip(numbers(sizes[what]), numbers(seconds), strict=True) if took
        ]
        for what, seconds, _ in tables[0]
    }


def errors_by_steps(tables: list[Rows]) -> dict[str, Line]:
    """Return the energy error of each method in u√n, by n: after a thousandth of each run, and at its end."""
    found: dict[str, Line] = {}
    for method, steps_a_period, steps, _, walk, end, *_ in tables[0]:
        line = found.setdefault(f"{method}, {steps_a_period} steps a period", [])
        line += [(float(steps) / 1000, float(walk)), (float(steps), float(end))]
    return {name: sorted(line) for name, line in found.items()}


def errors_by_wish(tables: list[Rows]) -> dict[str, Line]:
    """Return the errors that were found, by the errors that were wanted, for each thing that was to be accurate."""
    found: dict[str, Line] = {}
    for _, _, of_what, wanted, _, _, error, *_ in tables[1]:
        name = of_what if of_what in ("energy", "position") else "another constant of the motion"
        found.setdefault(name, []).append((float(wanted), float(error)))
    return found


@dataclass(frozen=True)
class Section:
    """What a section says: a sentence on what follows, which may take numbers that ``told`` finds, tables, a plot."""

    follows: str
    tables: tuple[Table, ...] = ()
    plot: Plot | Lines | None = None
    told: str = ""

    def page(self, title: str, command: str, printed: str, name: str) -> str:
        """Return the section as Markdown; an empty line that is not of the output would end a pattern, so none is."""
        found = re.search(self.told, printed, re.MULTILINE | re.DOTALL) if self.told else None
        if self.told and not found:
            raise ValueError(f"{name}: the output does not say what is told of it, {self.told!r}")
        sentence = self.follows.format(*found.groups()) if found else self.follows
        tables = "".join(table.markdown(printed) for table in self.tables)
        lines = [line for line in printed.splitlines() if line.startswith("|")]
        tables += re.sub(r"\n(?=\|[^\n]*\n\|---)", "\n\n", "\n".join(lines)) + "\n\n" if lines else ""
        drawn = self.plot.draw(self.tables, printed, name) if self.plot else ""
        folded = FOLDED.format(summary="What the script printed", printed=printed)
        return f"## {title}\n\n{sentence}\n\n{tables}{drawn}{command}\n\n{folded}"


_N = r"([\d.,]+)"
_SHARE = r"(\d+) \(\s*([\d.]+) %\)\s+(\d+) \(\s*[\d.]+ %\)\s+(\d+) \(\s*[\d.]+ %\)\s+(\d+) \(\s*[\d.]+ %\)"
SECTIONS = {
    "import_cost": Section(
        "`import canon` takes {0} ms; what a question needs is loaded with the question.",
        (Table(("statement", "ms", "× import sympy"), r"^(\S.*?)\s{2,}(\d+) ms\s+([\d.]+) ×"),),
        told=r"^import canon +(\d+) ms",
    ),
    "zero_test": Section(
        "Of {0} identities none was decided wrongly; {1} of the true ones were proved, every false "
        "one refuted.",
        (
            Table(
                (
                    "by",
                    "proved",
                    "refuted",
                    "wrong",
                    "undecided",
                    "too long",
                    "median ms",
                    "95 % ms",
                    "total s",
                ),
                rf"^(\w+) +(\d+/\d+) +(\d+/\d+) +(\d+) +(\d+) +(\d+) +{_N} +{_N} +{_N}$",
            ),
            Table(("large case", "s", "verdict"), r"^  (\S.*): ([\d.]+) s, ([a-z ]+)$"),
        ),
        told=r"^(\d+) identities.*?^canon +(\d+/\d+)",
    ),
    "canonical": Section(
        "Every map of the notes is proved canonical and every wrong twin of it refused; of the "
        "generating functions that exist, {0} % come in "
        "closed form.",
        (
            Table(
                ("map", "proved in, s", "wrong twins", "refused in, s"),
                r"^  (\S.*?)\s+HOLDS in ([\d.]+) s; (\d+) twin\(s\) refused in ([\d.]+) s",
            ),
        ),
        told=r"in closed form: .*?\(([\d.]+) %\)",
    ),
    "normal_forms": Section(
        "Exact normal forms to high orders, and a centre manifold with its error, take seconds."
    ),
    "derivation": Section(
        "Deriving takes {0} ms for one link and {1} ms for forty; how many times as long SymPy's "
        "methods take, the second table says.",
        (
            Table(
                (
                    "links",
                    "derive, ms",
                    "callable, ms",
                    "as SymPy, ms",
                    "H nodes, ms",
                    "H callable, ms",
                    "operations",
                ),
                r"^\s+(\d+) +([\d.]+) +([\d.]+) +([\d.]+) +([\d.]+) +([\d.]+) +(\d+)$",
            ),
            Table(
                ("links", "method", "derive", "call", "objects", "operations"),
                r"^ +(\w+Method) / canon: +derive ([\d.]+), call ([\d.]+), objects ([\d.]+), ops ([\d.]+)",
                under=r"^\s+(\d+) +[\d.]+ +[\d.]+ +[\d.]+ +[\d.]+ +[\d.]+ +\d+$",
            ),
            Table(
                ("other system", "ms to the first acceleration"), r"^  (\d* ?[a-zA-Z][\w ,]*?) {2,}([\d.]+)$"
            ),
        ),
        Plot(
            0, 0, 1, "Processor time to derive the equations of a pendulum of n links, both axes logarithmic"
        ),
        told=r"^ +1 +([\d.]+) .*?^ +40 +([\d.]+) ",
    ),
    "operations": Section(
        "Terms grouped before they are differentiated leave the fewest operations.",
        (
            Table(
                ("design", "5 links", "10 links", "20 links"),
                r"^(?!operations|links)(\D.*?\D) {2,}(\d+) +(\d+)(?: +(\d+))?$",
            ),
            Table(
                ("q̈ by the recursion that forms no M, links", "µs an evaluation"),
                r"^of +(\d+) links +([\d.]+)$",
            ),
        ),
    ),
    "minimal": Section(
        "A question loads what it needs: a scene without SymPy, a proof without an integrator.",
        (
            Table(("question", "process, ms", "loaded"), r"^(\S.*?) {2,}(\d+) ms(?:  (.*))?$"),
            Table(
                (
                    "reduced or constrained scene",
                    "variables",
                    "operations",
                    "processor time",
                    "drift of energy",
                ),
                r"^([\w-]+) +(\d+ → \d+) +(\d+ → \d+) +([\d.]+ ×) +(\S+ → \S+)$",
            ),
        ),
    ),
    "classroom": Section(
        "Two hundred students with {0} claims are judged in {1} s on two processes, and {2} verdicts "
        "differ from the truth.",
        (
            Table(
                ("students", "claims", "different ones", "hold", "fail", "undecided", "can't be judged"),
                r"^(\d+) holds, (\d+) fails, (\d+) undecided, (\d+) invalid$",
                under=r"^(\d+) students, (\d+) claims, (\d+) different ones",
            ),
            Table(
                (
                    "s in all",
                    "ms for each different claim",
                    "wrong answers with feedback",
                    "slowest claim, s",
                ),
                r"^wrong answers with feedback: (\d+ of \d+); slowest claim ([\d.]+) s$",
                under=r"^(\d+) s in all, (\d+) ms for each different claim$",
            ),
        ),
        told=r"(\d+) claims.*?^(\d+) s in all.*?found by evaluation: (\d+)",
    ),
    "feedback": Section(
        "Of {0} wrong answers most are told by name what was wrong with them, and a few only where; "
        "the last column counts false remarks.",
        (
            Table(
                ("slip or kind of claim", "answers", "named", "% named", "placed", "silent", "false"),
                rf"^(\S.*?) +(\d+) +{_SHARE}$",
            ),
        ),
        Plot(
            0, 0, 3, "Share of wrong answers whose mistake was named, by slip and by kind of claim", bars=True
        ),
        told=r"^(\d+) wrong answers",
    ),
    "growth": Section(
        "Waiting grows about as the size where H is a sum over neighbours, and with claims, cases, samples and orbits; "
        "with the number of all pairs of bodies, once there are thousands of them, and somewhat faster than the number "
        "of links. A slope is that of the logarithms between the two largest sizes.",
        (
            Table(
                ("what", "processor seconds, from the smallest size to the largest", "slope"),
                r"^  seconds +([\d.][\d. ]*?) +slope ([\d.]+)$",
                under=r"^(\w.*)$",
            ),
            Table(("what", "sizes"), r"^  size +(\S.*)$", under=r"^(\w.*)$"),
        ),
        Lines(
            seconds_by_size,
            "size",
            "processor seconds",
            "Processor seconds by size, both logarithmic",
            panels=2,
        ),
    ),
    "sections": Section(
        "Points of many orbits side by side lie on the section to {0}; met as events of one orbit each takes {1} times "
        "as long, and by events of heyoka's Taylor method {2} times.",
        (
            Table(
                (
                    "points",
                    "orbits",
                    "steps a point",
                    "s",
                    "s of processor",
                    "farthest from the section",
                    "largest change of H",
                ),
                r"^  ([\d.]+) s, ([\d.]+) s of processor; largest \|x\| (\S+), largest change of H (\S+)$",
                under=r"^(\d+) points of (\d+) orbits, (\d+) steps of",
            ),
            Table(
                ("one orbit, its points met as events", "time a point, beside many orbits"),
                r"^  events of (.*), one orbit: (\d+) times as long a point$",
            ),
        ),
        told=r"largest \|x\| (\S+),.*?same method, one orbit: (\d+).*?Taylor method, one orbit: (\d+)",
    ),
    "kernels": Section(
        "Compiled loops take about as long as a C program of the same method, and less for many bodies; of many "
        "orbits side by side each costs a fraction of that.",
        (
            Table(
                ("system", "method", "C, ns a step", "double, × C", "compensated, × C"),
                r"^(\S.*?) {2,}([\w-]+) +derived.* C +([\d.]+) ns a step; double +([\d.]+) × C "
                r"compensated +([\d.]+) × C",
            ),
            Table(
                (
                    "side by side",
                    "method",
                    "C, ns a step",
                    "double, × C",
                    "compensated, × C",
                    "double-double, × C",
                ),
                r"^(\S.*?) {2,}([\w-]+) +C +([\d.]+) \(.*?double +([\d.]+) \(.*?compensated +([\d.]+) "
                r"\(.*?double-double +([\d.]+) \(",
            ),
            Table(
                (
                    "in processes of their own",
                    "processes",
                    "loop",
                    "least, ns a step",
                    "most",
                    "median",
                    "× C",
                ),
                r"^(FPUT 512, verlet), in (\d+) processes: (\w+) (\d+) to (\d+) ns a step, median (\d+) ns, "
                r"([\d.]+) × C$",
            ),
        ),
    ),
    "roofline": Section(
        "How near the loops come to what the processor can do: the least time that the busiest of its units needs for "
        "a step, as a share of the time that a step takes.",
        (
            Table(
                ("doubles a register", "fma", "add", "both", "div", "sqrt", "load", "store"),
                r"^  (\d) wide  fma +([\d.]+)  add +([\d.]+)  both +([\d.]+)  div +([\d.]+)  sqrt +([\d.]+)  "
                r"load +([\d.]+)  store +([\d.]+)$",
            ),
            Table(
                ("system", "method", "numbers", "orbits", "ns a step", "% of the bound", "by"),
                r"^(\S.*?) {2,}(\S+) +(double|compensated|double-double) +(\d+) orbits? +([\d.]+) ns .* "
                r"(\d+) % of the bound by (\w+)$",
            ),
        ),
    ),
    "waiting": Section(
        "A command of the command line waits for Python and SymPy first; machine code that an earlier call compiled is "
        "loaded.",
        (
            Table(
                (
                    "a fresh process",
                    "s by the clock",
                    "s of the processor",
                    "s where nothing was compiled before",
                ),
                r"^(\S.*?) {2,}([\d.]+) +([\d.]+)(?: +([\d.]+) where .*)?$",
            ),
        ),
    ),
    "preparation": Section(
        "A further motion of a system is prepared in less than a millisecond; code that was compiled once is loaded, "
        "and energies of motions in double-double are evaluated in 113 bits.",
        (
            Table(
                ("motion", "method", "whole call, ms", "its steps", "beside them"),
                r"^(\S.*?periods) +(\S+) +([\d.]+) +([\d.]+) +([\d.]+)$",
            ),
            Table(
                ("loop", "method", "numbers", "compiled, ms", "loaded, ms"),
                r"^(\S+) +(\S+) +(double|compensated|double-double) +([\d.]+) +([\d.]+)$",
            ),
            Table(
                ("double-double", "steps, ms", "with energies in 113 bits", "in 40 digits"),
                r"^([A-Za-z]+) +([\d.]+) +([\d.]+) +([\d.]+)$",
            ),
        ),
    ),
    "brouwer": Section(
        "Over the whole run the energy error grows as the root of the number of steps: Brouwer's "
        "law, the least that rounding allows. Two steps an orbit are far above it; they, and Gauss's method with eight "
        "stages, drift in the end.",
        (
            Table(
                (
                    "method",
                    "steps a period",
                    "steps",
                    "orbits",
                    "walk / u√n",
                    "end / u√n",
                    "exponent",
                    "max |ΔE/E|",
                ),
                r"^(\S+) +([\d.]+) +(\S+) +(\d+) +([\d.]+) +([\d.]+) +([\d.]+ ± [\d.]+) +\S+ +(\S+) +\d+$",
            ),
        ),
        Lines(
            errors_by_steps,
            "steps n",
            "energy error / u√n",
            "Energy error (root mean square) in u√n by the steps n: after a thousandth of each run, and at its end; "
            "level where Brouwer's law holds",
        ),
    ),
    "headline": Section(
        "Methods that know Kepler's motion are the cheapest by far, and RK4 ends with the largest "
        "error of all.",
        (
            Table(
                ("problem", "method", "run", "max |ΔE/E|", "CPU s", "whole span: error", "CPU s"),
                r"^    (\S.*?) {2,}(\S+) +(\S+) +([\d.]+) +(\S+) +([\d.]+)",
                under=r"^(Kepler’s ellipse|Outer solar system)",
            ),
        ),
    ),
    "peers": Section(
        "Where a ratio is below 1, canon's cheapest method takes less time than that of any other library that "
        "reaches the accuracy: by its loop, and by the whole of a further call over a thousand periods.",
        (
            Table(
                ("problem", "max |ΔE/E|", "canon / the cheapest other", "by the whole call"),
                r"^    canon ([\d.]+) × the cheapest other(?:, ([\d.]+) × (?:with the call|by the whole call))?",
                under=r"^(\S.*), max \|ΔE/E\| ≤ (\S+)$",
            ),
        ),
        Plot(
            0,
            -1,
            2,
            "Time of canon's cheapest method over that of the cheapest other library, by problem and "
            "accuracy",
            bars=True,
        ),
    ),
    "peers_ensembles": Section(
        "Of ten thousand orbits each costs canon less than any other library takes, where a ratio is below 1.",
        (
            Table(
                ("problem", "method", "setting", "max |ΔE/E|", "its loop, µs an orbit", "the whole call"),
                r"^    (\S.*?) {2,}(\S+) +(\S+) +([\d.]+) µs an orbit, ([\d.]+) the whole call$",
                under=r"^(\S.*), \d+ orbits, max",
            ),
            Table(
                ("problem", "canon / the cheapest other", "by the whole call"),
                r"^    canon ([\d.]+) × the cheapest other, ([\d.]+) × by the whole call$",
                under=r"^(\S.*), \d+ orbits, max",
            ),
        ),
    ),
    "peers_losing": Section(
        "Where steps have to vary by many powers of ten, or where forces of a tree suffice, other libraries may take "
        "less time; the last column says who does.",
        (
            Table(
                ("problem", "error", "canon / the cheapest other", "by the whole call", ""),
                r"^    canon (\S+) × the cheapest other, (\S+) × by the whole call: (.*)$",
                under=r"^(\S.*), error ≤ (\S+)$",
            ),
            Table(
                ("problem", "wanted", "method", "setting", "error", "its loop, µs", "the whole call"),
                r"^    (\S.*?) {2,}(\S+) +(\S+) +(\d+) µs, (\d+) the whole call$",
                under=r"^(\S.*), error ≤ (\S+)$",
            ),
        ),
    ),
    "planets": Section(
        "Wisdom and Holman's method is the cheapest at each accuracy, with a corrector where more "
        "than four digits are wanted.",
        (
            Table(
                ("method", "accuracy", "steps a period", "max |ΔE/E|", "µs a period"),
                r"^(\S.*?) {2,}(1e-\d+) +(\d+) +(\S+) +([\d.]+)$",
            ),
        ),
    ),
    "constraints": Section(
        "RATTLE takes {0} times as long as a C program of the same method, and constraints and rates stay "
        "kept to round-off.",
        (Table(("program", "ns a step", "× C"), r"^  (\S.*?) {2,}([\d.]+) ns a step(?: +([\d.]+) × C)?$"),),
        told=r"canon, double +\S+ ns a step +([\d.]+) × C",
    ),
    "nonholonomic": Section(
        "Where the motion is reversible and regular the energy error stays bounded; where it is chaotic it may wander, "
        "and where no reversal leads back it may drift. The slip is in rounding units of the constraints' terms.",
        (
            Table(
                (
                    "system",
                    "order",
                    "step",
                    "ΔE/E early",
                    "late",
                    "verdict",
                    "slip, u",
                    "ns a step",
                    "× Taylor",
                ),
                r"^  order (\d), step (\S+) +\|ΔE/E\| (\S+) early, (\S+) late  (\S+) +slip (\S+) u +(\d+) ns +(\S+) ×",
                under=r"^([a-z].*)$",
            ),
        ),
    ),
    "rotations": Section(
        "Times in parts of heyoka's: below one the method is cheaper. Between mirrors the place is asked for, "
        "elsewhere the energy. The last lines of the output have round-off: norms of attitudes after many steps, in "
        "units of 2⁻⁵³.",
        (
            Table(
                ("system", "method", "to 1e-04", "to 1e-08"),
                r"^(\S.*?) {2,}(\S+) +([\d.]+|–) +([\d.]+|–)$",
            ),
        ),
    ),
    "chaos": Section(
        "With one deviation an orbit costs one to two and a half times as much as alone; the last table counts "
        "verdicts on orbits that are known.",
        (
            Table(
                ("system and method", "1 vector", "2n vectors", "wanted"),
                r"^(\S.*?) {2,}([\d.]+) +([\d.]+) +([\d.]+, [\d.]+)$",
            ),
            Table(
                (
                    "indicator",
                    "periods",
                    "regular told regular",
                    "chaotic",
                    "not known",
                    "chaotic told regular",
                    "chaotic",
                    "not known",
                ),
                r"^(\S.*?) {2,}(\d+) +(\d+) +(\d+) +(\d+) +(\d+) +(\d+) +(\d+)$",
            ),
            Table(
                ("planets", "µs a step", "with MEGNO", "ratio", "MEGNO"),
                r"^((?:canon|REBOUND) \S.*?) {2,}([\d.]+) +([\d.]+) +([\d.]+) +([\d.]+)$",
            ),
        ),
    ),
    "scale_out": Section(
        "Two processes run a study of {0} cases {1} times as fast as one, about as much as the machine gives two "
        "processes that only compute, and all results are the same bit for bit.",
        (
            Table(
                ("round", "one process, s", "two, s", "times as fast", "two that only compute"),
                r"^round (\d+): one process +([\d.]+) s, two +([\d.]+) s: ([\d.]+) × "
                r"\(the machine gives two plain processes ([\d.]+) ×\)$",
            ),
            Table(
                ("orbits side by side", "one core, s", "two, s", "times as fast"),
                r"^ *(\d+) orbits: one core +([\d.]+) s, two +([\d.]+) s: ([\d.]+) ×$",
            ),
        ),
        told=r"speed-up of (\d+) cases on 2 processes: ([\d.]+) ×; results equal bit for bit",
    ),
    "drift_calibration": Section(
        "At a level of 1 % a slope is claimed falsely in {1} % of the model's series without a walk, and in {2} % of "
        "those with a walk as large as the scatter, which is found in {3} %. Noise with a memory of a twentieth of the "
        "run can't be told from a walk, and is called bounded in {0} %: there the assumptions end.",
        (
            Table(
                (
                    "series",
                    "deserves",
                    "right, %",
                    "bounded",
                    "round-off",
                    "wandering",
                    "secular",
                    "diverged",
                    "undecided",
                    "exponent in its interval",
                ),
                r"^(\S.*?) {2,}([a-z-]+) +" + r"([\d.]+) % +" * 6 + r"([\d.]+) %(?: +([\d.]+) %)? *$",
            ),
            Table(
                (
                    "variance of the walk over the scatter's",
                    "told secular at the level of 1 %",
                    "of 5 %",
                    "slope over its error",
                    "walk found, %",
                ),
                r"^ +([\d.]+|inf) +([\d.]+) % +([\d.]+) % +([\d.]+) +([\d.]+) %$",
            ),
            Table(
                (
                    "orbits of Hénon and Heiles by",
                    "bounded, %",
                    "round-off",
                    "wandering",
                    "secular",
                    "diverged",
                    "undecided",
                ),
                r"^(\S[^%]*?) {2,}" + r"([\d.]+) % +" * 5 + r"([\d.]+) %$",
            ),
        ),
        told=r"^memory of 1/20 of the run +bounded +([\d.]+) %"
        r".*?^ +0 +([\d.]+) %.*?^ +1 +([\d.]+) %[^\n]* ([\d.]+) %$",
    ),
    "robustness": Section(
        "Every attack of these ended in one of the ways that are meant, where the last column is 0.",
        (Table(("attack", "how many", "bad"), r"^(\S.*?): (\d+): .*; (\d+) bad"),),
    ),
    "tested_lines": Section(
        "Of the branches of the code the tests take {0} %; lines and branches together they run {1} %. Of those that "
        "are *argued*, `benchmarks/untaken_branches.toml` says why no test takes them: they need another system, they "
        "guard a proof against what no input is known for, or a budget would have to end just there. Of the modules "
        "beside the rooms (*canon*) more is run than is counted: what judges and proves runs in processes that end by "
        "a signal, with their parent or when their time is over, and such a process tells nothing of what it ran. The "
        "rest there is for Windows and macOS.",
        (
            Table(
                (
                    "room",
                    "lines",
                    "not run",
                    "branches",
                    "not taken",
                    "argued",
                    "branches taken, %",
                    "both, %",
                ),
                r"^(\w+) +(\d+) +(\d+) +(\d+) +(\d+) +(\d+) +([\d.]+) % +([\d.]+) %$",
            ),
        ),
        told=r"^all .* ([\d.]+) % +([\d.]+) %$",
    ),
    "mutation": Section(
        "Of {0} small changes of the code, drawn by a seed, {2} change what canon does, and its tests notice {3} % of "
        "those: {4} % by tests that were there when the sample was drawn, which is what to expect of a sample that "
        "nobody has read, and {1} more by tests that were written after the survivors had been read. Why each of the "
        "others changes nothing, or which test was written for it, stands in the output.",
        (
            Table(
                (
                    "room",
                    "lines",
                    "mutants",
                    "killed",
                    "by new tests",
                    "change nothing",
                    "alive",
                    "killed, %",
                ),
                r"^(\w[\w ]*?) +(\d+) +(\d+) +(\d+) +(\d+) +(\d+) +(\d+) +([\d.]+|–) %$",
            ),
        ),
        told=r"^all +\d+ +(\d+) +\d+ +(\d+) .*?"
        r"^(\d+) change what canon does, ([\d.]+) % of them are killed, ([\d.]+) %",
    ),
    "choose": Section(
        "The accuracy was kept in {0} cases, the cost was within a factor of 2 of what was "
        "foretold in {1}, and within 1.5 times the least that a search over all methods found in {2}.",
        (
            Table(
                ("over all cases", "so many", "ratios"),
                r"^(accuracy kept|cost within [^:]*)[^:]*: (\d+ of \d+)(?:; (.*))?$",
            ),
            Table(
                (
                    "scene",
                    "periods",
                    "of what",
                    "wanted",
                    "chosen, with its step or tolerance",
                    "error foretold",
                    "error",
                    "ms foretold",
                    "ms",
                    "over the best",
                    "s to choose",
                ),
                r"^(\S+) (\de\+\d+) (\S.*?) +(1e-\d+)  (\S.*?) +[a-z]+  (\S+) (\S+) +([\d.]+) +([\d.]+) +([\d.]+)  "
                r"\S.*? +(\d+\.\d)(?:  [A-Z ]+)?$",
            ),
        ),
        Lines(
            errors_by_wish,
            "error that was wanted",
            "error that was found",
            "Error that was found by the error that was wanted, both logarithmic; none lies above the broken line",
            equal="as large as it was wanted",
        ),
        told=r"accuracy kept .*?: (\d+ of \d+).*?predicted: (\d+ of \d+).*?of the search: (\d+ of \d+)",
    ),
}
PLAIN = Section("What was measured stands in what the script printed.")


def section_of(name: str) -> Section:
    """Return what is said of a benchmark; its output alone where nothing was written for it yet."""
    return SECTIONS.get(name, PLAIN)
