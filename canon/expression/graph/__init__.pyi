from .graph import Graph as Graph
from .graph import Node as Node
