"""Surfaces given by distance functions: solids, their combinations, and the tracing of rays.

>>> from brdfkit.distance_fields import box, sphere
>>> field = sphere(1) | box(2).translate((1, 0, 0))
>>> field([[0, 0, 3]])    # the distance at (0, 0, 3)
array([2.])

A field is a tree of nodes (`node.py`). Each kind of node in `shapes/` has one formula, written with
`functions.py`, which runs on Dr.Jit arrays, on NumPy points, and on symbols that write GLSL. The
other folders work on any field:

`tracing/`    where rays meet it, and how hits move with its parameters
`export/`     files, meshes, grids, GLSL
`shadows/`    soft shadows by a march along one ray
`shading/`    pictures, by the integrator `distance_field`
"""

from brdfkit.distance_fields.checking import check as check
from brdfkit.distance_fields.export.json_files import from_json as from_json
from brdfkit.distance_fields.export.json_files import load as load
from brdfkit.distance_fields.export.mesh import Mesh as Mesh
from brdfkit.distance_fields.export.mesh import to_mesh as to_mesh
from brdfkit.distance_fields.materials import made_of as made_of
from brdfkit.distance_fields.node import Node as Node
from brdfkit.distance_fields.shapes.circular_arrays import circular_array as circular_array
from brdfkit.distance_fields.shapes.combinations import difference as difference
from brdfkit.distance_fields.shapes.combinations import intersection as intersection
from brdfkit.distance_fields.shapes.combinations import union as union
from brdfkit.distance_fields.shapes.fractals import mandelbulb as mandelbulb
from brdfkit.distance_fields.shapes.grids import grid as grid
from brdfkit.distance_fields.shapes.mesh_distances import from_mesh as from_mesh
from brdfkit.distance_fields.shapes.motions import rotate as rotate
from brdfkit.distance_fields.shapes.motions import scale as scale
from brdfkit.distance_fields.shapes.motions import translate as translate
from brdfkit.distance_fields.shapes.offsets import dilate as dilate
from brdfkit.distance_fields.shapes.offsets import shell as shell
from brdfkit.distance_fields.shapes.repetition import repeat as repeat
from brdfkit.distance_fields.shapes.rods import capped_cone as capped_cone
from brdfkit.distance_fields.shapes.rods import capped_cylinder as capped_cylinder
from brdfkit.distance_fields.shapes.rods import capsule as capsule
from brdfkit.distance_fields.shapes.solids import box as box
from brdfkit.distance_fields.shapes.solids import plane as plane
from brdfkit.distance_fields.shapes.solids import rounded_box as rounded_box
from brdfkit.distance_fields.shapes.solids import sphere as sphere
from brdfkit.distance_fields.shapes.solids import torus as torus
from brdfkit.distance_fields.shapes.users_functions import from_function as from_function
from brdfkit.distance_fields.tracing.cone_tracing import cone_trace as cone_trace
from brdfkit.distance_fields.tracing.cone_tracing import intersect as intersect
from brdfkit.distance_fields.tracing.cone_tracing import pixel_tangent as pixel_tangent
from brdfkit.distance_fields.tracing.hits import Hit as Hit
from brdfkit.distance_fields.tracing.hits import normal as normal
from brdfkit.distance_fields.tracing.hits import reattach as reattach
from brdfkit.distance_fields.tracing.raymarching import raymarch as raymarch
