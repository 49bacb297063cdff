"""Describes an object's maps as a Mitsuba scene: a rectangle as large as a photograph, with them.

The rectangle has the height 2 and lies in the plane z = 0; what is outside of the object is
transparent. It looks like the photographs in an orthographic camera along -z.
"""

from collections.abc import Mapping
from typing import Any

import numpy as np

from brdfkit.core.jit.llvm import use_variant
from brdfkit.inverse.photographs.maps.scene import (
    format_material_xml,
    format_texture,
    make_bitmap_texture,
    make_bsdf_dict,
)

DISTANCE = 2.0  # distance of the camera from the rectangle


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
            "bsdf": make_bsdf_dict(maps),
        },
    }


def format_object_xml(maps: Any, files: Mapping[str, str], mask_file: str) -> str:
    """Return a Mitsuba scene as XML: the object under the first photograph's light.

    `files` maps the name of each map to its file beside the scene.
    """
    height, width = maps.shape
    lights = maps.capture.lights
    x, y, z = (-float(v) for v in lights.directions[0])
    colour = ", ".join(repr(float(v)) for v in lights.intensities[0])
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
