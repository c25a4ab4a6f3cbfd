r"""
A study: systems × methods × steps
==================================

Which step may Verlet's method, RK4 and a method of order 8 have on three systems? A study is every combination,
kept in one file as the cases finish; killed, it goes on where it was.
"""

import tempfile
from pathlib import Path

import matplotlib.pyplot as plt

from canon import Study, results_of, run_study
from canon.plot import plot_study_heatmap

study = Study.of(
    system=["simple-pendulum", "henon-heiles", "toda"],
    method=["verlet", "rk4", "kahan-li-8"],
    step=[0.2, 0.1, 0.05],
    span=2000.0,
)
store = Path(tempfile.mkdtemp()) / "steps.sqlite"
print(run_study(study, store))

# %%
results = results_of(store)
figure, axes = plt.subplots(figsize=(7, 3.5), layout="constrained")
plot_study_heatmap(results, axes)

# %%
# Asked again, by what one wants to know: where does the energy run away?
for result in results.where(verdict=["secular", "diverged"]):
    print(f"{result.case.system:16} {result.setting!s:14} energy error {result.numbers['bound']:.0e}")

# %%
# Run a second time the study has nothing to do:
print(run_study(study, store))
