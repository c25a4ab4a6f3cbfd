from .sheet import Claim as Claim
from .sheet import Sheet as Sheet
from .sheet import read_sheet as read_sheet
