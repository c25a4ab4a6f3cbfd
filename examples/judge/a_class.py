r"""
A class of twelve
=================

Twelve answers to one question, as they come: in momenta or with the terms in another order, with a lost factor,
with a sign, and one that can't be read. Equal answers are judged once.
"""

from collections import Counter

import matplotlib.pyplot as plt

from canon import check
from canon.exercise import MarkingPolicy

question = {
    "kind": "legendre-hamiltonian",
    "q": ["r", "phi"],
    "p": ["p_r", "p_phi"],
    "parameters": {"m": "positive", "k": "positive", "r": "positive"},
    "L": "m*(r_dot**2 + r**2*phi_dot**2)/2 + k/r",
}
typed = """\
p_r**2/(2*m) + p_phi**2/(2*m*r**2) - k/r
p_r^2/(2m) + p_phi^2/(2m r^2) - k/r
(p_r**2 + p_phi**2/r**2)/(2*m) - k/r
$\\frac{p_r^2}{2m} + \\frac{p_\\phi^2}{2 m r^2} - \\frac{k}{r}$
p_r**2/(2*m) + p_phi**2/(2*m*r**2) + k/r
p_r**2/(2*m) + p_phi**2/(2*m) - k/r
p_r**2/(2*m) + p_phi**2*r**2/(2*m) - k/r
p_r**2/m + p_phi**2/(m*r**2) - k/r
p_r**2/(2*m) + p_phi**2/(2*m*r**2) - k/r
m*r_dot**2/2 + m*r**2*phi_dot**2/2 - k/r
p_r**2/(2*m) + (p_phi**2/(2*m*r**2) - k/r
p_r**2/(2*m) - k/r + p_phi**2/(2*m*r**2)""".splitlines()

# %%
report = check([{**question, "id": f"no. {k}", "H": text} for k, text in enumerate(typed, 1)])
for judgement, text in zip(report.judgements, typed, strict=True):
    print(f"{judgement.status:9} {text:50} {judgement.feedback or judgement.known}")

# %%
# What can't be read is no zero: whoever wrote it is asked again.
policy = MarkingPolicy(right=2, wrong=0)
marks = [policy.mark(judgement) for judgement in report.judgements]
counts = Counter(judgement.status for judgement in report.judgements)
figure, axes = plt.subplots(figsize=(5, 2.5), layout="constrained")
axes.barh(list(counts), list(counts.values()))
axes.set(xlabel="answers", title="H of a planet in polar coordinates")
points = [mark.points for mark in marks if mark.points is not None]
print(f"{sum(points):g} of {2 * len(points)} points, {sum(mark.asks_again for mark in marks)} asked again")
