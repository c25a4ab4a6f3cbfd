from .machine_code import MachineCode as MachineCode
from .machine_code import compiled as compiled
