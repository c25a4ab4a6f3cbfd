from .repair import Repair as Repair
from .screening import Screening as Screening
