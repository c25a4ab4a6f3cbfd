"""The collection of maps is shared by the tests of this room and by the benchmark."""

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parent))
