from .hamilton_equations import Equations as Equations
from .program import Program as Program
