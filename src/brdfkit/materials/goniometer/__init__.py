"""`measure`: a virtual goniometer, which path-traces light through microgeometry.

`microgeometry.py` has the shapes of surfaces; `specimen.py` a surface with the BSDFs of its facets,
and paths through it; `measuring.py` plans how many paths each cell of the table needs, and collects
their means and standard errors.
"""

from brdfkit.materials.goniometer.measuring import measure as measure
