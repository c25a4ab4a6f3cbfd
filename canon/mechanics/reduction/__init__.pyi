from .routh import Routhian as Routhian
from .routh import routhian as routhian
