"""A part of a scene that has a shadow map of its own."""

from collections.abc import Callable
from dataclasses import dataclass

from brdfkit.shadow_maps.projection import Projection


@dataclass(frozen=True)
class Part:
    """The `projection` of its map, and which points (`mi.Point3f`) it `contains`: a `mi.Bool`."""

    projection: Projection
    contains: Callable
