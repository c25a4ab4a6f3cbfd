from .tower import Tower as Tower
