"""`Measured`: a BRDF given by data, and what it is between and beyond its samples.

`interpolation.py`: scattered samples; `tabulation.py`: any BRDF as a table; `spectra.py`:
wavelengths and colours; `selection.py`: some of the samples.
"""

from brdfkit.measured.measured import Measured as Measured
