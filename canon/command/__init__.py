"""Commands of ``canon``: what each reads and prints; nowhere else does canon print."""

COMMANDS = {
    "check": "judge sheets of claims about mechanics: right or wrong, and where",
    "choose": "find the cheapest method, step and precision for a wanted accuracy",
    "completion": "print a script that completes commands and scenes on the tab key, in five shells",
    "drift": "run long and measure how the errors of a method grow",
    "scene": "list ready systems; show one's equations, run it, draw it",
    "serve": "judge claims over HTTP, with a page where people type them",
    "study": "run, resume, export and report studies of many cases, on one machine or many",
    "tour": "judge bundled answers and run a bundled system, in less than half a minute",
}
"""A module each, which is imported when it is asked for."""
