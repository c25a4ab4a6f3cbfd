r"""
One answer, and what is wrong with it
=====================================

Three students write the equation of a bead on a parabolic wire. Each answer is judged as it was written, LaTeX
or plain; a wrong one is told where it is wrong.
"""

from canon import check
from canon.exercise import MarkingPolicy

question = {
    "kind": "euler-lagrange",
    "q": ["x"],
    "parameters": {"m": "positive", "a": "positive", "g": "positive"},
    "L": "m*(1 + 4*a**2*x**2)*x_dot**2/2 - m*g*a*x**2",
}
answers = {
    "anna": "(1 + 4a^2 x^2) x'' + 4a^2 x x'^2 + 2 g a x = 0",
    "ben": "(1 + 4a^2 x^2) x'' + 8a^2 x x'^2 + 2 g a x = 0",
    "chris": r"$\ddot x = -\frac{2 a x\,(g + 2 a \dot x^2)}{1 + 4 a^2 x^2}$",
}

# %%
report = check([{**question, "id": name, "claim": [answer]} for name, answer in answers.items()])
print(report)

# %%
# Anna and Chris wrote different equations with the same solutions. What Ben is told was tried: the repaired
# answer was proved.
ben = report.judgements[1]
print("Ben is told:", ben.feedback)
print("The right one:", ben.corrected)

# %%
# For a program there is a mark, and a reason for each mark that is not full:
policy = MarkingPolicy(right=5, wrong=1)
for judgement in report.judgements:
    mark = policy.mark(judgement)
    print(f"{judgement.id}: {mark.points} points, {mark.outcome}")
