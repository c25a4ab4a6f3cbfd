"""Questions of proof that claims come down to, and the systems of equations they are asked about."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
