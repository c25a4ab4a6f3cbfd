"""The wrong twin of right.py: each line with a mark is told by both, mypy and pyright."""

from canon import RK4, CanonicalTransformation, drift

drift("no run")  # wrong
RK4(order=5)  # wrong
status = CanonicalTransformation([], []).is_canonical().stauts  # wrong
