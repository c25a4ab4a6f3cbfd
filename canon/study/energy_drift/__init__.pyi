from .drift import Drift as Drift
from .drift_study import DriftStudy as DriftStudy
