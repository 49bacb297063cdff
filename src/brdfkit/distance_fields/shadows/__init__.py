"""Soft shadows of distance functions from a single ray; one file is one method.

Each method takes a field, a `LightCone` and its own settings, and returns a `Shadow`; they are
called by name from `soft_shadow`, which checks arguments and result, and so runs the kernel. A
renderer calls the methods themselves: nothing in them ends the recording of a kernel.
"""

from brdfkit.distance_fields.shadows.cone import LightCone as LightCone
from brdfkit.distance_fields.shadows.cone import light_cone as light_cone
from brdfkit.distance_fields.shadows.edge import Edge as Edge
from brdfkit.distance_fields.shadows.edge import edge as edge
from brdfkit.distance_fields.shadows.shadow import Shadow as Shadow
from brdfkit.distance_fields.shadows.soft_shadow import soft_shadow as soft_shadow
