"""Forms of programs made the forms that people write: rates with names of their own, operators before operands."""
