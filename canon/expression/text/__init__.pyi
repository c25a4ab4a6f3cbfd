from .scope import Scope as Scope
from .syntax import parse_syntax as parse_syntax
