"""`Measured`: a BRDF given by samples or by a table, and its values between and beyond them.

`measured_data.py`: samples and tables as they are given, checked by `validation.py`;
`from_angles.py`: a user's own, by angles (`coordinates.py`) or by columns (`columns.py`), whose
names say what they are (`column_names.py`), also with wavelengths in rows (`long_form.py`);
`mending.py`: samples of another convention; `measured.py`: their lookup; `interpolation.py`:
between scattered samples; `tabulation.py`: any BRDF as a table; `mixing.py` and
`spectrum_to_rgb.py`: channels, wavelengths and colours; `arithmetic.py`: what a BRDF leaves of it;
`selection.py`: the samples that a fit uses; `coverage.py`: the share of all directions that was
measured, by distances of `pair_points.py`; `checksum.py`: knows it again.
"""

from brdfkit.materials.measured.measured import Measured as Measured
