"""``python -m canon`` is the same as ``canon``."""

import sys

from canon.cli import main

if __name__ == "__main__":
    sys.exit(main())
