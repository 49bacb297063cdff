"""`Measured`: a BRDF given by scattered samples or by a table, which can be evaluated anywhere.

`measured.py` defines the class, on top of the data in `measured_data.py`, which `validation.py`
checks. `from_angles.py` makes it from a user's own samples: `column_names.py` interprets the names
of a table's columns, `columns.py` converts them with `angles.py` and `coordinates.py`, and
`long_form.py` rearranges tables with one wavelength per row. `conventions.py` converts samples from
other conventions.

`interpolation.py` interpolates scattered samples, and `tabulation.py` tabulates any BRDF.
`arithmetic.py` and `spectrum_to_rgb.py` mix channels and subtract BRDFs. `selection.py` selects the
samples of a fit, `coverage.py` finds the share of all directions that was measured, and
`albedos.py` computes the albedo.
"""

from brdfkit.materials.measured.measured import Measured as Measured
