from .juxtaposition import parse_juxtaposed as parse_juxtaposed
from .scope import Scope as Scope
