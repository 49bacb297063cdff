"""The methods of shadows by their names."""

from brdfkit.distance_fields.shadows.convex import convex
from brdfkit.distance_fields.shadows.marches import base, discrete, hard, linear
from brdfkit.distance_fields.shadows.monte_carlo import monte_carlo
from brdfkit.distance_fields.shadows.rivals import aaltonen, quilez
from brdfkit.distance_fields.shadows.split import split

SOFT = {m.__name__: m for m in (linear, base, discrete, convex, split)}  # one march finds the edge
BY_EPSILON = SOFT | {hard.__name__: hard}
WITHOUT = {m.__name__: m for m in (quilez, aaltonen)}
METHODS = [*BY_EPSILON, *WITHOUT, monte_carlo.__name__]


def by_name(shadow, field, cone, epsilon, direction, rays):
    """The `Shadow` of the method called `shadow`, with those of the settings that it has."""
    if shadow in BY_EPSILON:
        return BY_EPSILON[shadow](field, cone, epsilon, direction)
    if shadow in WITHOUT:
        return WITHOUT[shadow](field, cone)
    return monte_carlo(field, cone, rays)
