"""Soft shadows of distance fields, by one march along a cone from a surface point to the light.

Each method takes a field, a `LightCone` and its own settings, and returns a `Shadow`. `soft_shadow`
calls a method by its name and checks arguments and result, for which it runs the kernel. A renderer
calls the methods directly, as nothing in them interrupts the recording of a kernel.
"""

from brdfkit.distance_fields.shadows.cone import LightCone as LightCone
from brdfkit.distance_fields.shadows.cone import make_light_cone as make_light_cone
from brdfkit.distance_fields.shadows.edge import Edge as Edge
from brdfkit.distance_fields.shadows.edge import find_edge as find_edge
from brdfkit.distance_fields.shadows.shadow import Shadow as Shadow
from brdfkit.distance_fields.shadows.soft_shadow import soft_shadow as soft_shadow
