"""`measure`: a virtual goniometer, which path-traces light through microgeometry.

`microgeometry.py`: the shapes of surfaces; `specimen.py`: a surface with its facets' material;
`measuring.py`: the paths, and the table that they add up to.
"""

from brdfkit.goniometer.measuring import measure as measure
