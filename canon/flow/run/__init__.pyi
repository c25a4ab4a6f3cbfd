from .event import Event as Event
from .sampling_plan import Plan as Plan
from .sampling_plan import sampling as sampling
