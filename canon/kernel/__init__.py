"""Compiled numerics: from expression graphs to machine code and to heyoka."""
