"""What a person or a program is told of judged claims: table, JSON lines, JUnit XML, page."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
