"""A measured material: `Measured`, and what lies between its samples."""

from brdfkit.measured.measured import Measured as Measured
