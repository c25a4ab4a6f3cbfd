from .bracket import lagrange_bracket as lagrange_bracket
from .bracket import lie_bracket as lie_bracket
from .bracket import poisson_bracket as poisson_bracket
from .hamiltonian import Hamiltonian as Hamiltonian
