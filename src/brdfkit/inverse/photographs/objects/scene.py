"""Describes an object's maps as a Mitsuba scene: a rectangle as large as a photograph, with them.

The rectangle has the height 2 and lies in the plane z = 0; what is outside of the object is
transparent. It looks like the photographs in an orthographic camera along -z.

Textures interpolate between pixels, those at the object's edge also with pixels outside of it. So
these get the values of the nearest pixel of the object, or else the edge is seen as a line.
"""

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np

from brdfkit.core.array_types import FloatArray
from brdfkit.core.jit.llvm import use_variant
from brdfkit.inverse.photographs.maps.scene import (
    format_material_xml,
    format_texture,
    make_bitmap_texture,
    make_bsdf_dict,
)

DISTANCE = 2.0  # distance of the camera from the rectangle


PADDING = 4  # distance from the object up to which pixels get values of its edge


def pad_maps(maps: Any) -> dict[str, FloatArray]:
    """Return the maps of an `ObjectMaps`, with the values of the edge also in pixels around it."""
    from scipy.ndimage import distance_transform_edt

    distances, (rows, columns) = distance_transform_edt(~maps.mask, return_indices=True)
    around = (distances > 0) & (distances <= PADDING)
    padded = {name: values.copy() for name, values in maps.maps.items()}
    for name, values in maps.maps.items():
        padded[name][around] = values[rows[around], columns[around]]
    return padded


def make_object_dict(maps: Any) -> dict[str, Any]:
    """Return the object of an `ObjectMaps` as a Mitsuba dictionary: a masked rectangle at z = 0."""
    import mitsuba as mi

    use_variant()
    height, width = maps.shape
    return {
        "type": "rectangle",
        "to_world": mi.ScalarTransform4f().scale([width / height, 1, 1]),
        "bsdf": {
            "type": "mask",
            "opacity": make_bitmap_texture(maps.mask.astype(np.float32)),
            "bsdf": make_bsdf_dict(replace(maps, maps=pad_maps(maps))),
        },
    }


def format_object_xml(maps: Any, files: Mapping[str, str], mask_file: str) -> str:
    """Return a Mitsuba scene as XML: the object under the first photograph's light.

    `files` maps the name of each map to its file beside the scene. The light is a distant one, with
    the irradiance that a lamp nearby causes in the middle of the object.
    """
    height, width = maps.shape
    to_lights, irradiances = maps.capture.lights.illuminate(np.zeros((1, 3)))
    x, y, z = (-float(v) for v in to_lights[0, 0])
    colour = ", ".join(repr(float(v)) for v in irradiances[0, 0])
    return f"""<!-- Load after "import brdfkit", or render with: brdfkit render object.xml -->
<scene version="3.0.0">
  <integrator type="direct"/>
  <sensor type="orthographic" id="camera">
    <transform name="to_world">
      <scale x="{width / height!r}" y="{width / height!r}"/>
      <lookat origin="0, 0, {DISTANCE}" target="0, 0, 0" up="0, 1, 0"/>
    </transform>
    <film type="hdrfilm">
      <integer name="width" value="{width}"/>
      <integer name="height" value="{height}"/>
      <rfilter type="box"/>
    </film>
    <sampler type="multijitter"><integer name="sample_count" value="16"/></sampler>
  </sensor>
  <emitter type="directional" id="lamp">
    <vector name="direction" x="{x!r}" y="{y!r}" z="{z!r}"/>
    <rgb name="irradiance" value="{colour}"/>
  </emitter>
  <shape type="rectangle" id="object">
    <transform name="to_world"><scale x="{width / height!r}" y="1" z="1"/></transform>
    <bsdf type="mask">
      {format_texture("opacity", mask_file)}
{format_material_xml(maps, files)}
    </bsdf>
  </shape>
</scene>
"""
