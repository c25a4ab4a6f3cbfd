"""Fetch the inventories that cross-references to other projects' pages need: ``python docs/fetch_inventories.py``.

They are kept in ``docs/inventories``, so that building the pages needs no network; this script does, when they are
to be renewed. ``conf.py`` takes those that are there: without one of them its names are plain text instead of links.
"""

import urllib.request
from pathlib import Path

HERE = Path(__file__).parent / "inventories"
PAGES = {
    "heyoka": "https://bluescarni.github.io/heyoka.py",
    "matplotlib": "https://matplotlib.org/stable",
    "numpy": "https://numpy.org/doc/stable",
    "python": "https://docs.python.org/3",
    "scipy": "https://docs.scipy.org/doc/scipy",
    "sympy": "https://docs.sympy.org/latest",
}
SECONDS = 60


def mapping() -> dict[str, tuple[str, str]]:
    """Return the projects whose inventories are kept, as intersphinx takes them."""
    return {
        name: (page, f"inventories/{name}.inv")
        for name, page in PAGES.items()
        if (HERE / f"{name}.inv").exists()
    }


def fetch(name: str) -> None:
    """Write one inventory, if what comes is one."""
    with urllib.request.urlopen(f"{PAGES[name]}/objects.inv", timeout=SECONDS) as answer:
        found = answer.read()
    if not found.startswith(b"# Sphinx inventory version 2"):
        raise ValueError(
            f"{PAGES[name]}/objects.inv is no inventory of Sphinx; look where its pages have gone"
        )
    (HERE / f"{name}.inv").write_bytes(found)


if __name__ == "__main__":
    for project in PAGES:
        try:
            fetch(project)
        except (OSError, ValueError) as error:
            print(f"{project}: not fetched ({error})")
        else:
            print(f"{project}: fetched")
