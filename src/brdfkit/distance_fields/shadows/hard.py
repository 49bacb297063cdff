"""`hard`: the shadow of the light's centre, whose edge is as wide as the ball: a pixel.

[Bálint et al. 2019, section 4.1]
"""

from brdfkit.distance_fields.shadows.marches import linear


def hard(field, cone, epsilon=1 / 20, direction="A"):
    """The `Shadow` of `linear` for a light of radius 0."""
    return linear(field, cone.to_point(), epsilon, direction)
