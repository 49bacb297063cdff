"""Describes the sample as a Mitsuba scene: a rectangle whose textures are the maps."""

from collections.abc import Iterable, Mapping
from typing import Any

import numpy as np

from brdfkit.core.array_types import FloatArray
from brdfkit.core.jit.llvm import use_variant
from brdfkit.inverse.photographs.maps.shape_parameters import ANGLE
from brdfkit.model import labels

# Light below the surface is lost, as in the formula of the fit, which has the same values as the
# plugin wherever a normal faces the camera
NORMAL_MAP = {"type": "robust_normal_map", "conserve_energy": False}


def make_sample_dict(svbrdf: Any) -> dict[str, Any]:
    """Return the sample of an `Svbrdf` or `Maps` as a Mitsuba dictionary: a rectangle at z = 0."""
    import mitsuba as mi

    use_variant()
    width, height = svbrdf.size
    return {
        "type": "rectangle",
        "to_world": mi.ScalarTransform4f().scale([width / 2, height / 2, 1]),
        "bsdf": make_bsdf_dict(svbrdf),
    }


def make_bsdf_dict(svbrdf: Any) -> dict[str, Any]:
    """Return the material of an `Svbrdf` or `Maps` as a Mitsuba dictionary, textured by maps."""
    maps = svbrdf.maps
    textures = {name: make_bitmap_texture(maps[name]) for name in _list_parameter_maps(maps)}
    material = {**_make_plugin_dict(svbrdf.model), **svbrdf.fixed, **textures}
    if ANGLE in maps:
        # Angles jump by π along a line of the map, where interpolated ones would be wrong
        angle = make_bitmap_texture(maps[ANGLE]) | {"filter_type": "nearest"}
        material = {"type": "tangent_rotation", "angle": angle, "bsdf": material}
    normals = make_bitmap_texture((maps["normal"] + 1) / 2)
    return {**NORMAL_MAP, "normalmap": normals, "bsdf": material}


def _list_parameter_maps(maps: Iterable[str]) -> list[str]:
    """Return the names of the maps that are parameters of the BRDF model."""
    return [name for name in maps if name not in ("normal", ANGLE)]


def _make_plugin_dict(label: str) -> dict[str, Any]:
    """Return the type and the options of the Mitsuba plugin for a BRDF model's label."""
    model = labels.model(label)
    return {"type": model.type_name(), **model.changed_options()}


def make_bitmap_texture(values: FloatArray) -> dict[str, Any]:
    """Return the dictionary of a Mitsuba texture with the values of a map."""
    import mitsuba as mi

    # Mitsuba puts the first row of a bitmap at the lower edge of a rectangle
    pixels = np.ascontiguousarray(np.atleast_3d(values)[::-1], np.float32)
    return {
        "type": "bitmap",
        "bitmap": mi.Bitmap(pixels),
        "raw": True,
        "filter_type": "bilinear",
        "wrap_mode": "clamp",
    }


def format_scene_xml(svbrdf: Any, files: Mapping[str, str]) -> str:
    """Return a Mitsuba scene as XML: the sample in the first photograph's light and camera.

    `files` maps the name of each map to its file beside the scene. The first row of a map is the
    sample's upper edge.
    """
    width, height = svbrdf.size
    capture = svbrdf.capture
    camera, size = capture.cameras[0], capture.picture_size
    look = " ".join(
        f'{name}="{_join_with_commas(getattr(camera, name))}"'
        for name in ("origin", "target", "up")
    )
    clips = "\n".join(f'    <float name="{n}" value="{v!r}"/>' for n, v in camera.clips().items())
    return f"""<!-- Load after "import brdfkit", or render with: brdfkit render sample.xml -->
<scene version="3.0.0">
  <integrator type="direct"/>
  <sensor type="perspective" id="camera">
    <float name="fov" value="{camera.fov!r}"/>
    <string name="fov_axis" value="x"/>
{clips}
    <transform name="to_world">
      <lookat {look}/>
    </transform>
    <film type="hdrfilm">
      <integer name="width" value="{size[0]}"/>
      <integer name="height" value="{size[1]}"/>
      <rfilter type="box"/>
    </film>
    <sampler type="multijitter"><integer name="sample_count" value="16"/></sampler>
  </sensor>
  <emitter type="point" id="lamp">
    <point name="position" {_format_xyz(capture.positions[0])}/>
    <rgb name="intensity" value="{_join_with_commas(capture.intensities[0])}"/>
  </emitter>
  <shape type="rectangle" id="sample">
    <transform name="to_world"><scale x="{width / 2!r}" y="{height / 2!r}" z="1"/></transform>
{format_material_xml(svbrdf, files)}
  </shape>
</scene>
"""


def format_material_xml(svbrdf: Any, files: Mapping[str, str]) -> str:
    """Return the material of maps as XML: a normal map around the model, textured by their files.

    `files` maps the name of each map to its file beside the scene.
    """
    textures = "\n".join(
        f"        {format_texture(name, files[name])}" for name in _list_parameter_maps(svbrdf.maps)
    )
    turning, inner, end = "", "", ""
    if ANGLE in svbrdf.maps:
        angle = format_texture("angle", files[ANGLE], "nearest")
        turning, end = f'<bsdf type="tangent_rotation">\n        {angle}\n        ', "</bsdf>"
        inner = 'name="bsdf" '
    plugin = _make_plugin_dict(svbrdf.model)
    values = {**{name: v for name, v in plugin.items() if name != "type"}, **svbrdf.fixed}
    numbers = "\n".join(
        f'        <{_name_xml_type(value)} name="{name}" value="{value}"/>'
        for name, value in values.items()
    )
    return f"""    <bsdf type="{NORMAL_MAP["type"]}">
      <boolean name="conserve_energy" value="{str(NORMAL_MAP["conserve_energy"]).lower()}"/>
      {format_texture("normalmap", files["normal"])}
      {turning}<bsdf {inner}type="{plugin["type"]}">
{textures}
{numbers}
      </bsdf>{end}
    </bsdf>"""


def format_texture(name: str, file: str, interpolation: str = "bilinear") -> str:
    """Return the XML of a Mitsuba texture that is read from a file."""
    return (
        f'<texture type="bitmap" name="{name}"><string name="filename" value="{file}"/>'
        '<boolean name="raw" value="true"/><string name="wrap_mode" value="clamp"/>'
        f'<string name="filter_type" value="{interpolation}"/>'
        # Mitsuba puts the first row of a picture at the lower edge of a rectangle
        '<transform name="to_uv"><scale y="-1"/><translate y="1"/></transform></texture>'
    )


def _name_xml_type(value: float | str) -> str:
    """Return the name of Mitsuba's XML element for values of this type."""
    return {int: "integer", float: "float", str: "string"}[type(value)]


def _join_with_commas(numbers: Iterable[float]) -> str:
    """Return numbers as text, separated by commas."""
    return ", ".join(repr(float(number)) for number in numbers)


def _format_xyz(numbers: Iterable[float]) -> str:
    """Return three numbers as the XML attributes x, y and z."""
    return " ".join(f'{axis}="{float(n)!r}"' for axis, n in zip("xyz", numbers, strict=True))
