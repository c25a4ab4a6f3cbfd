from .hamilton_equations import HamiltonEquations as HamiltonEquations
from .program import Program as Program
