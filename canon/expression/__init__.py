"""SymPy at the border, graphs inside: symbols, the safe expression language, the expression graph."""
