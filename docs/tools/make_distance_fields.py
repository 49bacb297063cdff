"""Makes `docs/distance_fields.md`, a gallery of surfaces given by distance functions.

    python docs/tools/make_distance_fields.py     # a quarter of an hour on two cores

A scene (`distance_field_gallery/scenes.py`) that has a picture keeps it: delete the picture to draw
it anew. Lessons (`distance_field_gallery/lessons.py`), which are small pictures beside each other,
are drawn and measured each time.
"""

import inspect
import runpy
import time
from pathlib import Path

import drjit as dr
import mitsuba as mi
import numpy as np
from distance_field_gallery import lessons  # which imports brdfkit before Mitsuba
from distance_field_gallery.highlights import SIZES, errors_by_roughness, highlights
from distance_field_gallery.scenes import SCENES
from make_models import paragraphs, table
from PIL import Image, ImageDraw, ImageFont

from brdfkit.core.colours import to_srgb

PAGE = Path(__file__).parents[1] / "distance_fields.md"
FOLDER = PAGE.with_suffix("")
GALLERY = Path(__file__).with_name("distance_field_gallery")
GYROID, START = GALLERY / "gyroid.py", GALLERY / "start.py"
SIZE, SPP = (720, 450), 16  # of a scene
SMALL, SMALL_SPP, TURNS = (300, 225), 4, 3  # of a lesson; its time is the least of some turns
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


def page(figures):
    """The text of the page; `figures`: what is said of the errors of a lesson, by its function."""
    start = (
        BEGIN,
        shown("distance_field_start", "A cut cube"),
        code(START.read_text(encoding="utf-8")),
    )
    scenes = [text for make in SCENES for text in (f"### {title(make)}", *section(make))]
    own = "The node of one's own:", code(GYROID.read_text(encoding="utf-8"))
    compared = [
        text
        for make in lessons.LESSONS
        for text in (f"## {title(make)}", *section(make), figures[make])
    ]
    return paragraphs(
        *("# Distance fields: a gallery", INTRO),
        *("## A quick look", LOOK),
        *("## What a field becomes", BECOMES),
        *("## A scene of Mitsuba's", *start),
        *("## Six scenes", SCENE, *scenes, *own),
        *compared,
        *("## What a bound is", BOUND),
        MORE,
    )


def title(make):
    return inspect.getdoc(make).partition(": ")[0]


def section(make):
    """Sentences and picture by the docstring of a function, and the function itself."""
    _, _, text = inspect.getdoc(make).partition(": ")
    source = inspect.getsource(make).replace(f'    """{make.__doc__}"""\n', "")
    return text[0].upper() + text[1:], shown(make.__name__, title(make)), code(source)


def shown(name, title):
    return f"![{title}](distance_fields/{name}.png)"


def code(source):
    return f"```python\n{source.strip()}\n```"


def draw_scene(make):
    """Draw the picture of a scene, if there is none."""
    if not file(make.__name__).exists():
        print(make.__name__, flush=True)
        write(image(mi.render(mi.load_dict(with_film(make(), SIZE)), spp=SPP)), make.__name__)


def draw_lesson(make):
    """Draw the pictures of a lesson; return the table of their errors if one is the truth."""
    found = {name: rendered(scene) for name, scene in make().items()}
    write(sheet({name: image(picture) for name, (picture, _) in found.items()}), make.__name__)
    first, last = next(iter(found)), list(found)[-1]
    if last not in lessons.TRUTHS:
        return ""
    (truth, _), (_, unit) = found[last], found[first]
    rows = [
        (f"`{n}`", f"{np.sqrt(np.mean((p - truth) ** 2)):.4f}", f"{s / unit:.1f}")
        for n, (p, s) in found.items()
    ]
    said = {"brightest": truth.max(), "truth": last, "rays": lessons.RAYS, "first": first}
    more = by_roughness() if make is highlights else ""
    return paragraphs(table("method, error, time", rows), FIGURES.format(**said), more)


def by_roughness():
    """What is said of the errors of highlights by roughness and by the size of the lamp."""
    rows = [
        (f"α = {alpha:g}", *(f"{100 * mean:+.0f} %, {rms:.2f}" for mean, rms in errors))
        for alpha, *errors in errors_by_roughness()
    ]
    head = ", ".join(["radius / distance", *(f"{size:g}" for size in SIZES)])
    return paragraphs(ROUGHNESSES, table(head, rows))


def rendered(scene):
    """(linear picture, seconds of all threads) of a small scene, the first turn to compile."""
    loaded, seconds = mi.load_dict(with_film(scene, SMALL)), []
    for _ in range(1 + TURNS):
        began = time.process_time()
        picture = mi.render(loaded, spp=SMALL_SPP)
        dr.eval(picture)
        dr.sync_thread()
        seconds.append(time.process_time() - began)
    return np.array(picture), min(seconds[1:])


def with_film(scene, size):
    film = {"type": "hdrfilm", "width": size[0], "height": size[1], "pixel_format": "rgb"}
    return scene | {"sensor": scene["sensor"] | {"film": film}}


def sheet(pictures):
    """One image of all pictures, with their labels below."""
    columns = min(COLUMNS, len(pictures))
    wide, high = SMALL[0], SMALL[1] + LINE
    page = Image.new("RGB", (columns * wide, -(-len(pictures) // columns) * high), "white")
    draw, font = ImageDraw.Draw(page), ImageFont.load_default(14)
    for k, (label, picture) in enumerate(pictures.items()):
        x, y = k % columns * wide, k // columns * high
        page.paste(picture, (x, y))
        draw.text((x + wide // 2, y + high - LINE // 2), label, "black", font, anchor="mm")
    return page


def image(linear):
    return Image.fromarray((255 * to_srgb(np.array(linear)) + 0.5).astype(np.uint8))


def file(name):
    return FOLDER / f"{name}.png"


def write(picture, name):
    picture.save(file(name), optimize=True)


if __name__ == "__main__":
    mi.set_variant("llvm_ad_rgb")
    FOLDER.mkdir(exist_ok=True)
    write(image(runpy.run_path(str(START))["picture"]), "distance_field_start")
    for make in SCENES:
        draw_scene(make)
    figures = {make: draw_lesson(make) for make in lessons.LESSONS}
    PAGE.write_text(page(figures), encoding="utf-8")
