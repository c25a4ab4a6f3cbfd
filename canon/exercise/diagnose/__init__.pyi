from .change import Change as Change
from .change import Mistake as Mistake
from .diagnosis import Diagnosis as Diagnosis
from .right_answer import corrected as corrected
