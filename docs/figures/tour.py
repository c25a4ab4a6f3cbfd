"""Make docs/figures/tour.png, the figure that ``canon tour`` writes."""

from pathlib import Path

from canon.cli import main

if __name__ == "__main__":
    raise SystemExit(main(["tour", "--plot", str(Path(__file__).with_suffix(".png"))]))
