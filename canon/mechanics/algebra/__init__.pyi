from .linear import SingularMatrixError as SingularMatrixError
from .linear import solve as solve
from .substitution import substitute as substitute
