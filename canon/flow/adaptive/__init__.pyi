from .dop853 import dop853_motion as dop853_motion
