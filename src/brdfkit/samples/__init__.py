"""A BRDF as arrays: samples at direction pairs, and tables over half/difference angles."""

from brdfkit.samples.samples import Samples as Samples
from brdfkit.samples.table import Table as Table
