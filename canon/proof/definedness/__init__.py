"""Where expressions have values: denominators, logarithms and pieces that take them away."""
