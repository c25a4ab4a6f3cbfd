from .question import Question as Question
from .question import decide as decide
