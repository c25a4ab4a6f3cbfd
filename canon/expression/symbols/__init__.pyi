from .symbol import Coordinate as Coordinate
from .symbol import Momentum as Momentum
from .symbol import coordinates as coordinates
from .symbol import parameters as parameters
