"""A BRDF as arrays: samples at direction pairs, and tables over half/difference angles."""

from brdfkit.model.samples.samples import Samples as Samples
from brdfkit.model.samples.table import Table as Table
