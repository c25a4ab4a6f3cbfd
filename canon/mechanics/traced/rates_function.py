"""Rates as a function f(t, y) of Python, told from the values that canon and others know as systems."""

from __future__ import annotations

from typing import Any

from canon.expression.symbols.input_in_words import module_of

__all__ = ["is_rates_function"]


def is_rates_function(system: Any) -> bool:
    """Tell whether a system is a function f(t, y) and no value that canon knows."""
    own = module_of(type(system)).partition(".")[0] in (
        "canon",
        "sympy",
        "heyoka",
    )  # a vector field can be called
    return callable(system) and not own and not isinstance(system, type) and not hasattr(system, "H")
