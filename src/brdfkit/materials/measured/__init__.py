"""`Measured`: a BRDF given by samples or by a table, and its values between and beyond them.

`measured.py` has the class, and `measured_data.py` the data below it, which `validation.py` checks.
A user's own samples come by angles or by the columns of a table (`from_angles.py`): the names of
the columns say what these are (`column_names.py`), `columns.py` converts them with the help of
`angles.py` and `coordinates.py`, and `long_form.py` collects wavelengths that stand in rows.
`conventions.py` mends samples of another convention.

`interpolation.py` gives values between scattered samples, `tabulation.py` tables of any BRDF,
`arithmetic.py` and `spectrum_to_rgb.py` other channels and differences. `selection.py` chooses the
samples that a fit uses, `coverage.py` finds the share of all directions that was measured, and
`albedos.py` the light that the material reflects.
"""

from brdfkit.materials.measured.measured import Measured as Measured
