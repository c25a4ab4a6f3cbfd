from .studied_motion import Subject as Subject
from .studied_motion import subject_of as subject_of
