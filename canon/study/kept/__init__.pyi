from .chunk_file import ChunkFolder as ChunkFolder
from .kept_arrays import Kept as Kept
from .kept_motion import KeptMotion as KeptMotion
