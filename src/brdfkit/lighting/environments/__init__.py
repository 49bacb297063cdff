"""Environment maps as files: read, audited, and converted from one convention to another.

`map_files.py` reads and writes them; `layouts.py` and `cubes.py`: where in a picture a direction
lies; `conventions.py`: which direction of the world that is, by the names of programs;
`resampling.py` and `converting.py` turn one into another; `compass.py` draws the map that shows
what a program does; `auditing.py`, `spread.py`, `report.py` and `picture.py` are what `brdfkit info
MAP.exr` tells.
"""

from brdfkit.lighting.environments.auditing import EnvironmentAudit as EnvironmentAudit
from brdfkit.lighting.environments.auditing import audit_environment as audit_environment
from brdfkit.lighting.environments.converting import convert_environment as convert_environment
