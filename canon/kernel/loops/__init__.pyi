from .gauss import gauss_loop as gauss_loop
from .splitting import splitting_loop as splitting_loop
