from .body import RigidBody as RigidBody
from .constraint import ConstrainedLagrangian as ConstrainedLagrangian
from .lagrangian import Lagrangian as Lagrangian
