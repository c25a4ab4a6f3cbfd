from .anatomy import Anatomy as Anatomy
