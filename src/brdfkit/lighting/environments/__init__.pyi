from .auditing import EnvironmentAudit as EnvironmentAudit
from .auditing import audit as audit
from .converting import convert as convert
