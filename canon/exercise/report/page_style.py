"""Style sheet of the report page: light and dark, on screen and on paper."""

__all__ = ["PAGE_STYLE", "STYLE"]

PAGE_STYLE = "body { margin: 0; } @media (prefers-color-scheme: dark) { body { background: #14181f; } }\n"
STYLE = """
.canon { --ink: #1c2430; --faint: #5c6675; --paper: #fff; --line: #d9dee6; --holds: #1a7f4b; --fails: #b3261e;
  --undecided: #8a6100; --invalid: #6b3fa0; color: var(--ink); background: var(--paper); max-width: 60rem;
  margin: 0 auto; padding: 1rem; font: 16px/1.5 system-ui, sans-serif; }
@media (prefers-color-scheme: dark) { .canon { --ink: #e6e9ee; --faint: #a2acba; --paper: #14181f; --line: #343c49;
  --holds: #5fd396; --fails: #ff8a80; --undecided: #f0c052; --invalid: #c9a6f5; } }
.canon h1 { font-size: 1.5rem; margin: 0 0 .5rem; }
.canon h2 { font-size: 1.1rem; margin: 0; }
.canon .counts span { margin-right: 1.2rem; font-weight: 600; }
.canon .claim { border: 1px solid var(--line); border-left: .35rem solid var(--faint); border-radius: .4rem;
  padding: .7rem 1rem; margin: .9rem 0; break-inside: avoid; overflow-x: auto; }
.canon .claim.holds { border-left-color: var(--holds); } .canon .claim.fails { border-left-color: var(--fails); }
.canon .claim.undecided { border-left-color: var(--undecided); }
.canon .claim.invalid { border-left-color: var(--invalid); }
.canon .holds .verdict, .canon .counts .holds { color: var(--holds); }
.canon .fails .verdict, .canon .counts .fails { color: var(--fails); }
.canon .undecided .verdict, .canon .counts .undecided { color: var(--undecided); }
.canon .invalid .verdict, .canon .counts .invalid { color: var(--invalid); }
.canon .verdict { display: inline-block; min-width: 6.5rem; }
.canon .about { color: var(--faint); font-size: .85rem; margin: .1rem 0 .6rem; }
.canon .about > * { margin-right: 1rem; }
.canon dl { display: grid; grid-template-columns: max-content 1fr; gap: .15rem 1rem; margin: .4rem 0; }
.canon dt { color: var(--faint); font-family: ui-monospace, monospace; font-size: .85rem; padding-top: .15rem; }
.canon dd { margin: 0; } .canon dd > div { padding: .1rem 0; }
.canon .entry { display: inline-block; margin-right: 1.2rem; vertical-align: top; }
.canon .entry > div { display: inline-block; margin-right: 1rem; }
.canon .feedback { font-weight: 600; margin: .5rem 0; white-space: pre-wrap; }
.canon pre.feedback { font-family: ui-monospace, monospace; font-weight: 400; font-size: .9rem; }
.canon .counterexample { margin: .3rem 0; } .canon .corrected > div { padding: .1rem 1rem; }
.canon .warning { color: var(--undecided); margin: .3rem 0; }
.canon details { margin-top: .5rem; } .canon summary { cursor: pointer; color: var(--faint); }
.canon ol { margin: .4rem 0; padding-left: 1.6rem; } .canon li { padding: .1rem 0; }
.canon math { font-family: "STIX Two Math", "Latin Modern Math", "Cambria Math", "Noto Sans Math",
  "DejaVu Math TeX Gyre", math; math-style: normal; } .canon code { font-size: .9em; word-break: break-word; }
@media print { .canon details { display: block; } }
"""
