from .first_order import CanonicalEquations as CanonicalEquations
from .second_order import SecondOrderEquations as SecondOrderEquations
from .second_order import derivation as derivation
