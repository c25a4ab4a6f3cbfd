from .flow_jacobian import FlowJacobian as FlowJacobian
from .flow_jacobian import reversal_error as reversal_error
from .flow_jacobian import symplecticity_defect as symplecticity_defect
from .flow_series import FlowSeries as FlowSeries
