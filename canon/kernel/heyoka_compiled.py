"""Integrators compiled by heyoka, whose machine code is kept in a small folder of canon's own."""

from __future__ import annotations

from functools import cache
from typing import Any

__all__ = ["MOST_KEPT", "compiled_integrator"]

MOST_KEPT = 128 * 2**20
"""Bytes of machine code that are kept between processes, some 900 integrators; the oldest go first."""


def compiled_integrator(equations: Any, state: Any, **options: Any) -> Any:
    """Return heyoka's ``taylor_adaptive`` of some equations, from the machine code that is kept where there is some."""
    import heyoka as hy

    _keep_apart()
    hy.set_logger_level_error()  # its warnings, of steps that canon reports itself, go to standard output
    return hy.taylor_adaptive(equations, state, **options)


@cache
def _keep_apart() -> None:
    """Have heyoka keep machine code below its own folder for it, and not much of it.

    SQLite reads the whole file whenever a process opens it, and heyoka keeps 21 GB: at 6.8 GB the first orbit of every
    process waited for 20 s. Where nothing can be written nothing is kept; heyoka would warn at each compilation.
    """
    import heyoka as hy

    kept = hy.llvm_state
    if not kept.get_diskcache_enabled():
        return
    try:
        folder = kept.get_diskcache_path() / "canon"
        folder.mkdir(parents=True, exist_ok=True)
        kept.set_diskcache_path(folder)
        kept.set_diskcache_limit(MOST_KEPT)
    except (OSError, RuntimeError):  # heyoka's own errors, of its file, are RuntimeErrors
        kept.set_diskcache_enabled(False)
