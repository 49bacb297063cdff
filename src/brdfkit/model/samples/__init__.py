"""Measured BRDFs as arrays: samples at direction pairs, tables over half and difference angles."""

from brdfkit.model.samples.samples import Samples as Samples
from brdfkit.model.samples.table import Table as Table
