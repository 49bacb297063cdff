"""`measure`: a virtual goniometer, which finds a rough surface's BRDF by tracing paths.

`microgeometry.py` makes height fields. `specimen.py` gives their facets Mitsuba BSDFs, and traces
paths between the facets. `measuring.py` plans how many paths each cell of the BRDF's table needs,
and computes means and standard errors.
"""

from brdfkit.materials.goniometer.measuring import measure as measure
