"""Links to what a page is made of when the documentation is built: scripts, the list of public names, the commands.

Someone who reads a page in the repository finds the source behind such a link; on the built page it leads to the page
that was made of that source.
"""

from __future__ import annotations

import re
from posixpath import dirname, join, normpath, relpath

__all__ = ["made_of", "with_built_links"]

_MADE_OF = {
    r"examples": "gallery/index",
    r"examples/(?!grading/|sheets/)(\w+/\w+)\.py": r"gallery/\1",
    r"canon/(?:\w+/)?__init__\.pyi": "reference/api.md",
    r"canon/cli\.py": "reference/command_line.md",
}
_OUT_OF_DOCS = re.compile(r"\]\(((?:\.\./)+[\w./-]+)\)")


def made_of(source: str) -> str:
    """Return the page, from the folder of all pages, that is made of a file of the repository; "" where none is.

    Examples
    --------
    >>> made_of("examples/explore/a_cloud_of_starts.py"), made_of("canon/cli.py"), made_of("canon/command/tour.py")
    ('gallery/explore/a_cloud_of_starts', 'reference/command_line.md', '')
    """
    for pattern, page in _MADE_OF.items():
        if found := re.fullmatch(pattern, source):
            return found.expand(page)
    return ""


def with_built_links(page: str, source: str) -> str:
    """Return the source of a page, its links to what pages are made of leading to those pages.

    Examples
    --------
    >>> with_built_links("index", "[Worked examples](../examples), [scenes](scenes.md), [files](../examples/sheets)")
    '[Worked examples](gallery/index), [scenes](scenes.md), [files](../examples/sheets)'
    """
    here = dirname(page)

    def built(link: re.Match[str]) -> str:
        made = made_of(normpath(join("docs", here, link[1])))
        return f"]({relpath(made, here or '.')})" if made else link[0]

    return _OUT_OF_DOCS.sub(built, source)
