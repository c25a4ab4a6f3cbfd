from .diagnosis import Diagnosis as Diagnosis
from .feedback import corrected as corrected
