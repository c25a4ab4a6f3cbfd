"""The thumbnail of worked examples without a figure: what they show is a verdict.

python docs/figures/verdict.py
"""

from pathlib import Path

import matplotlib as mpl

mpl.use("Agg")
import matplotlib.pyplot as plt

figure = plt.figure(figsize=(4, 2.8))
for row, (sign, word, colour) in enumerate((("✓", "holds", "#2a7f3f"), ("✗", "fails", "#b3261e"))):
    height = 0.66 - 0.4 * row
    figure.text(0.2, height, sign, fontsize=40, color=colour, family="DejaVu Sans", va="center")
    figure.text(0.4, height, word, fontsize=32, color="0.25", va="center")
figure.savefig(Path(__file__).with_suffix(".png"), dpi=100)
