"""A BRDF as numbers: samples at direction pairs, and tables of them. No file, no policy."""

from brdfkit.samples.samples import Samples as Samples
from brdfkit.samples.table import Table as Table
