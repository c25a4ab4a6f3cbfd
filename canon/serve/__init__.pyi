from .http_server import serve as serve
from .service_limits import Limits as Limits
from .web_application import application as application
