from .splitting_schemes import SCHEMES as SCHEMES
from .splitting_schemes import Scheme as Scheme
