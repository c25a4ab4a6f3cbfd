"""Links with which a tutorial is opened on mybinder.org and run there, without installing anything.

They need a public repository. The build asks the service that makes it which one that is, and leaves the links out
where there is none, as on one's own machine.
"""

from __future__ import annotations

import os
import re
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Mapping

__all__ = ["repository", "with_a_link"]

_ON_GITHUB = re.compile(r"github\.com[:/]([\w.-]+/[\w.-]+?)(?:\.git)?/?$")
_TITLE = re.compile(r"^# .+$", re.MULTILINE)


def repository(environment: Mapping[str, str] = os.environ) -> str:
    """Return owner and name of the repository that is built, as GitHub and Read the Docs say it; "" elsewhere.

    Examples
    --------
    >>> repository({"READTHEDOCS_GIT_CLONE_URL": "https://github.com/someone/canon.git"})
    'someone/canon'
    >>> repository({})
    ''
    """
    found = _ON_GITHUB.search(environment.get("READTHEDOCS_GIT_CLONE_URL", ""))
    return environment.get("GITHUB_REPOSITORY") or (found.group(1) if found else "")


def with_a_link(page: str, source: str, where: str) -> str:
    """Return the source of a tutorial with a link under its title; any other page as it is.

    Examples
    --------
    >>> print(with_a_link("tutorials/1_pendulum", "# A pendulum", "someone/canon"))
    # A pendulum
    <BLANKLINE>
    [Run this page on Binder](https://mybinder.org/v2/gh/someone/canon/HEAD?urlpath=lab/tree/docs/tutorials/1_pendulum.md)
    >>> with_a_link("index", "# canon", "someone/canon"), with_a_link("tutorials/1_pendulum", "# A pendulum", "")
    ('# canon', '# A pendulum')
    """
    if not (where and page.startswith("tutorials/")):
        return source
    link = f"https://mybinder.org/v2/gh/{where}/HEAD?urlpath=lab/tree/docs/{page}.md"
    return _TITLE.sub(lambda title: f"{title.group()}\n\n[Run this page on Binder]({link})", source, count=1)
