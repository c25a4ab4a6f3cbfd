from .study import Study as Study
from .study import read_study as read_study
