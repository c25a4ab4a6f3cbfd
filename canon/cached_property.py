"""Cached properties that hold no lock, as those of Python 3.12 and later.

Those of Python 3.11 share one lock among all objects of a class: threads wait for each other's compilations, and a
child forked while another thread computes one waits for ever (https://github.com/python/cpython/issues/87634).
"""

from __future__ import annotations

import functools
import sys
from typing import TYPE_CHECKING, Any

__all__ = ["cached_property"]

if TYPE_CHECKING or sys.version_info >= (3, 12):
    from functools import cached_property
else:

    class cached_property(functools.cached_property):
        """A property that is computed once for an object; by each of the threads that ask for it meanwhile."""

        def __get__(self, instance: Any, owner: Any = None) -> Any:
            if instance is None:
                return self
            known = instance.__dict__
            if self.attrname not in known:
                known[self.attrname] = self.func(instance)
            return known[self.attrname]
