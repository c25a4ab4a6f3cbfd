from .domain import Domain as Domain
from .verdict import Status as Status
from .verdict import Verdict as Verdict
