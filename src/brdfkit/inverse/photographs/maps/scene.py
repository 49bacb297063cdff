"""The sample as Mitsuba has it: a rectangle, whose textures are the maps."""

import numpy as np

from brdfkit.core.jit.llvm import use_variant
from brdfkit.inverse.photographs.maps.shape_parameters import ANGLE
from brdfkit.model import labels


def sample_dict(svbrdf):
    """The dictionary of the sample of an `Svbrdf`, in the plane z = 0."""
    import mitsuba as mi

    use_variant()
    width, height = svbrdf.size
    return {
        "type": "rectangle",
        "to_world": mi.ScalarTransform4f().scale([width / 2, height / 2, 1]),
        "bsdf": bsdf_dict(svbrdf),
    }


def bsdf_dict(svbrdf):
    """The dictionary of its BSDF."""
    maps = svbrdf.maps
    textures = {name: _texture(maps[name]) for name in _parameters(maps)}
    material = {**_type(svbrdf.model), **svbrdf.fixed, **textures}
    if ANGLE in maps:
        angle = _texture(maps[ANGLE]) | {"filter_type": "nearest"}  # it has a seam
        material = {"type": "tangent_rotation", "angle": angle, "bsdf": material}
    normals = _texture((maps["normal"] + 1) / 2)
    return {"type": "normalmap", "normalmap": normals, "bsdf": material}


def _parameters(maps):
    """The names of the maps that are parameters of the model."""
    return [name for name in maps if name not in ("normal", ANGLE)]


def _type(label):
    """The plugin's type and options of a model's label."""
    model = labels.model(label)
    return {"type": model.type_name(), **model.chosen()}


def _texture(values):
    import mitsuba as mi

    # the first row of Mitsuba's bitmap is the lower edge of a rectangle
    pixels = np.ascontiguousarray(np.atleast_3d(values)[::-1], np.float32)
    return {
        "type": "bitmap",
        "bitmap": mi.Bitmap(pixels),
        "raw": True,
        "filter_type": "bilinear",
        "wrap_mode": "clamp",
    }


def scene_xml(svbrdf, files):
    """The text of a scene: the sample under the first light, seen by the first photograph's camera.

    `files`: the name of each map's file, which lies beside it, its first row the upper edge.
    """
    width, height = svbrdf.size
    capture = svbrdf.capture
    camera, size = capture.cameras[0], capture.picture_size
    textures = "\n".join(
        f"        {_file_texture(name, files[name])}" for name in _parameters(svbrdf.maps)
    )
    turning, inner, end = "", "", ""
    if ANGLE in svbrdf.maps:
        angle = _file_texture("angle", files[ANGLE], "nearest")
        turning, end = f'<bsdf type="tangent_rotation">\n        {angle}\n        ', "</bsdf>"
        inner = 'name="bsdf" '
    clips = "\n".join(f'    <float name="{n}" value="{v!r}"/>' for n, v in camera.clips().items())
    kind = _type(svbrdf.model)
    values = {**{name: v for name, v in kind.items() if name != "type"}, **svbrdf.fixed}
    numbers = "\n".join(
        f'        <{_tag(value)} name="{name}" value="{value}"/>' for name, value in values.items()
    )
    return f"""<!-- Load after "import brdfkit", or render with: brdfkit render sample.xml -->
<scene version="3.0.0">
  <integrator type="direct"/>
  <sensor type="perspective" id="camera">
    <float name="fov" value="{camera.fov!r}"/>
    <string name="fov_axis" value="x"/>
{clips}
    <transform name="to_world">
      <lookat origin="{_csv(camera.origin)}" target="{_csv(camera.target)}" up="{_csv(camera.up)}"/>
    </transform>
    <film type="hdrfilm">
      <integer name="width" value="{size[0]}"/>
      <integer name="height" value="{size[1]}"/>
      <rfilter type="box"/>
    </film>
    <sampler type="multijitter"><integer name="sample_count" value="16"/></sampler>
  </sensor>
  <emitter type="point" id="lamp">
    <point name="position" {_xyz(capture.positions[0])}/>
    <rgb name="intensity" value="{_csv(capture.intensities[0])}"/>
  </emitter>
  <shape type="rectangle" id="sample">
    <transform name="to_world"><scale x="{width / 2!r}" y="{height / 2!r}" z="1"/></transform>
    <bsdf type="normalmap">
      {_file_texture("normalmap", files["normal"])}
      {turning}<bsdf {inner}type="{kind["type"]}">
{textures}
{numbers}
      </bsdf>{end}
    </bsdf>
  </shape>
</scene>
"""


def _file_texture(name, file, between="bilinear"):
    return (
        f'<texture type="bitmap" name="{name}"><string name="filename" value="{file}"/>'
        '<boolean name="raw" value="true"/><string name="wrap_mode" value="clamp"/>'
        f'<string name="filter_type" value="{between}"/>'
        # Mitsuba's rectangles have a picture's first row at their lower edge
        '<transform name="to_uv"><scale y="-1"/><translate y="1"/></transform></texture>'
    )


def _tag(value):
    """The element of Mitsuba's XML for a value."""
    return {int: "integer", float: "float", str: "string"}[type(value)]


def _csv(numbers):
    return ", ".join(repr(float(number)) for number in numbers)


def _xyz(numbers):
    return " ".join(f'{axis}="{float(n)!r}"' for axis, n in zip("xyz", numbers, strict=True))
