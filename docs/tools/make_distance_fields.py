"""Makes `docs/distance_fields.md`, a gallery of surfaces that distance functions define.

    python docs/tools/make_distance_fields.py     # a quarter of an hour on two cores

The picture of a scene (`distance_field_gallery/scenes.py`) is drawn only if it does not exist yet.
Lessons (`distance_field_gallery/lessons.py`), small pictures next to each other, are drawn and
measured each time.
"""
# ruff: noqa: I001, for brdfkit comes first: it chooses the LLVM that Mitsuba loads

import inspect
import runpy
import time
from pathlib import Path

import brdfkit  # noqa: F401
import drjit as dr
import mitsuba as mi
import numpy as np
from distance_field_gallery import lessons
from distance_field_gallery.highlights import SIZES, compute_errors_by_roughness, highlights
from distance_field_gallery.scenes import SCENES
from make_models import join_paragraphs, make_table
from PIL import Image, ImageDraw, ImageFont

from brdfkit.core.colours import to_srgb

PAGE = Path(__file__).parents[1] / "distance_fields.md"
FOLDER = PAGE.with_suffix("")
GALLERY = Path(__file__).with_name("distance_field_gallery")
GYROID, START = GALLERY / "gyroid.py", GALLERY / "start.py"
SIZE, SPP = (720, 450), 16  # size [pixels] and samples per pixel of a scene's picture
# Size and samples per pixel of a lesson's pictures, and number of renderings whose time is measured
SMALL, SMALL_SPP, TURNS = (300, 225), 4, 3
COLUMNS, LINE = 4, 22  # pictures in a row, pixels of a label
INTRO = """A distance function says of each point how far the nearest surface is, negative inside.
brdfkit combines such functions in Python and renders them by the Mitsuba integrator
[`distance_field`](plugins/distance_field.md), with measured materials and soft shadows from a
single march for each point and lamp. Nothing is random but the places within a pixel, so that there
is no noise, unless it is asked for. There is no light between surfaces either, only that of the
lamps.

[`make_distance_fields.py`](tools/make_distance_fields.py) makes this page from the code that it
shows."""
LOOK = """`bk.render` shows any field, of any size. A part with the name of a material that
brdfkit knows is made of it. In a notebook the picture appears below the cell.

```python
import brdfkit as bk
from brdfkit.distance_fields import box, plane, sphere

cup = (sphere(1) - sphere(0.9) - box(2).at(0, 0, 1.3)).at(0, 0, 1).made_of("blasted_gold")
bk.render(cup | plane()).write("cup.png")
```"""
BEGIN = """`|` is the union, `&` the intersection, `-` the difference, as in fogleman's
[sdf](https://github.com/fogleman/sdf). A part has the material whose name `made_of` gives; the rest
is grey."""
SCENE = """What is common to the scenes, `scene`, `bulb`, `panel`, `camera` and `cove`, is in
[`stage.py`](tools/distance_field_gallery/stage.py). Materials with a name are measured ones that
come along: [all of them](materials/README.md)."""
FIGURES = """*Error*: root mean square over the pixels, of linear values up to {brightest:.1f}, from
`{truth}`, {rays} rays for each point. *Time*: of the whole picture, over that of `{first}`."""
ROUGHNESSES = """How far `split` is from `exact`, for a ball and a ground of rough metal: of the
mean of the picture, and as root mean square over that of the picture. It is right within 6 % where
the lamp's radius over its distance is at most half of α, the roughness of GGX. For more, take
`shading="estimated"`; its shadows have no derivatives."""
BECOMES = """A file: `load` reads it again, `brdfkit render cup.json` shows it. Scene files name it:
`<integrator type="distance_field"><string name="filename" value="cup.json"/> ...`. A mesh, for
Mitsuba and modellers, also of what is endless, within bounds. GLSL, one function without loops.
A function of points is a field, too: `from_function(lambda p: ...)`. A node or a function of yours
is not saved, as no file can hold Python; a grid of it is: `field.to_grid(128, bounds=...)`.

```python
cup.save("cup.json")
cup.to_mesh(resolution=128).write("cup.ply")
(plane() - cup).to_mesh(bounds=((-2, -2, -1), (2, 2, 1))).write("dent.ply")
print(cup.to_glsl())  # float field(vec3 p) { ... }
```"""
BOUND = """A step of f / L meets no surface where L bounds the slope of f. Every node knows its L,
and operators pass it on. With an L that is too small, rays would step through walls: a field that
says so is refused when a scene is loaded, with a place. `check` and `check_steps` seek such places,
at random.

```python
class hasty(gyroid):
    lipschitz = 1.0  # too small: see above
    distance = gyroid.distance


check_steps(hasty(0.35).scale(0.17) & sphere(0.9))
# BrdfkitError: the field is -0.0101 at (0.408, -0.0587, 0.00171), but its surface is less than
# 0.0099 away: it is steeper than its bound 1; divide it by its slope.
```"""
MORE = """Errors of all methods on nine kinds of occluders: [errors of single-ray
shadows](single_ray_shadows.md). Derivatives through shadows: the notebook [Shadow of a
light](../notebooks/shadow_of_a_light.md)."""


def make_page(figures):
    """Return the text of the page; `figures`: text on the errors of a lesson, by its function."""
    start = (
        BEGIN,
        make_image_link("distance_field_start", "A cut cube"),
        make_code_block(START.read_text(encoding="utf-8")),
    )
    scenes = [text for make in SCENES for text in (f"### {read_title(make)}", *make_section(make))]
    own = "The node of one's own:", make_code_block(GYROID.read_text(encoding="utf-8"))
    compared = [
        text
        for make in lessons.LESSONS
        for text in (f"## {read_title(make)}", *make_section(make), figures[make])
    ]
    return join_paragraphs(
        *("# Distance fields: a gallery", INTRO),
        *("## A quick look", LOOK),
        *("## What a field becomes", BECOMES),
        *("## A scene of Mitsuba's", *start),
        *("## Six scenes", SCENE, *scenes, *own),
        *compared,
        *("## What a bound is", BOUND),
        MORE,
    )


def read_title(make):
    return inspect.getdoc(make).partition(": ")[0]


def make_section(make):
    """Return the text, picture and code for a scene; `make`: its function with a docstring."""
    _, _, text = inspect.getdoc(make).partition(": ")
    source = inspect.getsource(make).replace(f'    """{make.__doc__}"""\n', "")
    return (
        text[0].upper() + text[1:],
        make_image_link(make.__name__, read_title(make)),
        make_code_block(source),
    )


def make_image_link(name, title):
    return f"![{title}](distance_fields/{name}.png)"


def make_code_block(source):
    return f"```python\n{source.strip()}\n```"


def draw_scene(make):
    """Draw the picture of a scene, if it does not exist yet; `make`: function of the scene."""
    if not find_picture_file(make.__name__).exists():
        print(make.__name__, flush=True)
        write_picture(
            to_screen_image(mi.render(mi.load_dict(add_film(make(), SIZE)), spp=SPP)), make.__name__
        )


def draw_lesson(make):
    """Draw the pictures of a lesson, and return the table of their errors if one is the truth."""
    found = {name: render_timed(scene) for name, scene in make().items()}
    write_picture(
        make_sheet({name: to_screen_image(picture) for name, (picture, _) in found.items()}),
        make.__name__,
    )
    first, last = next(iter(found)), list(found)[-1]
    if last not in lessons.TRUTHS:
        return ""
    (truth, _), (_, unit) = found[last], found[first]
    rows = [
        (f"`{n}`", f"{np.sqrt(np.mean((p - truth) ** 2)):.4f}", f"{s / unit:.1f}")
        for n, (p, s) in found.items()
    ]
    said = {"brightest": truth.max(), "truth": last, "rays": lessons.RAYS, "first": first}
    more = describe_errors_by_roughness() if make is highlights else ""
    return join_paragraphs(make_table("method, error, time", rows), FIGURES.format(**said), more)


def describe_errors_by_roughness():
    """Return the text and table on errors of highlights, by roughness and size of the lamp."""
    rows = [
        (f"α = {alpha:g}", *(f"{100 * mean:+.0f} %, {rms:.2f}" for mean, rms in errors))
        for alpha, *errors in compute_errors_by_roughness()
    ]
    head = ", ".join(["radius / distance", *(f"{size:g}" for size in SIZES)])
    return join_paragraphs(ROUGHNESSES, make_table(head, rows))


def render_timed(scene):
    """Return the linear picture of a scene and the processor seconds of its rendering."""
    loaded, seconds = mi.load_dict(add_film(scene, SMALL)), []
    for _ in range(1 + TURNS):  # the first rendering compiles the kernels
        began = time.process_time()
        picture = mi.render(loaded, spp=SMALL_SPP)
        dr.eval(picture)
        dr.sync_thread()
        seconds.append(time.process_time() - began)
    return np.array(picture), min(seconds[1:])


def add_film(scene, size):
    film = {"type": "hdrfilm", "width": size[0], "height": size[1], "pixel_format": "rgb"}
    return scene | {"sensor": scene["sensor"] | {"film": film}}


def make_sheet(pictures):
    """Return one image of all pictures (by label), each with its label below."""
    columns = min(COLUMNS, len(pictures))
    wide, high = SMALL[0], SMALL[1] + LINE
    page = Image.new("RGB", (columns * wide, -(-len(pictures) // columns) * high), "white")
    draw, font = ImageDraw.Draw(page), ImageFont.load_default(14)
    for k, (label, picture) in enumerate(pictures.items()):
        x, y = k % columns * wide, k // columns * high
        page.paste(picture, (x, y))
        draw.text((x + wide // 2, y + high - LINE // 2), label, "black", font, anchor="mm")
    return page


def to_screen_image(linear):
    return Image.fromarray((255 * to_srgb(np.array(linear)) + 0.5).astype(np.uint8))


def find_picture_file(name):
    return FOLDER / f"{name}.png"


def write_picture(picture, name):
    picture.save(find_picture_file(name), optimize=True)


if __name__ == "__main__":
    mi.set_variant("llvm_ad_rgb")
    FOLDER.mkdir(exist_ok=True)
    write_picture(to_screen_image(runpy.run_path(str(START))["picture"]), "distance_field_start")
    for make in SCENES:
        draw_scene(make)
    figures = {make: draw_lesson(make) for make in lessons.LESSONS}
    PAGE.write_text(make_page(figures), encoding="utf-8")
