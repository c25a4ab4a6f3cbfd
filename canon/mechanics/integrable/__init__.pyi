from .classical_coordinates import Chart as Chart
from .hamilton_jacobi import CompleteIntegral as CompleteIntegral
from .hamilton_jacobi import hamilton_jacobi as hamilton_jacobi
from .separability import is_separable as is_separable
from .separability import levi_civita_condition as levi_civita_condition
from .separated_momenta import NotSeparatedError as NotSeparatedError
from .separated_momenta import SeparatedMomentum as SeparatedMomentum
