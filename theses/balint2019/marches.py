"""The four marches of the thesis, in the order of its tables."""

from brdfkit.distance_fields.shadows.base import base
from brdfkit.distance_fields.shadows.convex import convex
from brdfkit.distance_fields.shadows.discrete import discrete
from brdfkit.distance_fields.shadows.marches import linear

MARCHES = {march.__name__: march for march in (base, linear, discrete, convex)}
