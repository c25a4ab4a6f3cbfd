from .grammar import parse_latex as parse_latex
