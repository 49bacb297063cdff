"""Makes the environments of this folder, which are nobody else's, and so can be shipped.

    python data/environments/make.py           # all of them, in some minutes
    python data/environments/make.py studio    # one

`sky` is Mitsuba's `sunsky` above grey ground. `studio` and `room` are path-traced from a point
within, into all directions. `compass` is drawn. To add a map, write a function like
those below, and an entry in `index.toml`.

Rows and columns are those of Mitsuba's `envmap`. Every texel has the mean over its cell, so that
the sun, which is smaller, has its power. Seeds are fixed; values are rounded to half floats, and
those of another processor may differ by their last digit.
"""

import hashlib
import sys
from pathlib import Path

import numpy as np

from brdfkit.core.colours import luminance
from brdfkit.lighting.environments.conventions import parse_convention
from brdfkit.lighting.environments.light_distribution import pixel_directions, pixel_solid_angles
from brdfkit.lighting.environments.map_files import write_map
from brdfkit.lighting.environments.resampling import resample

HEIGHT = 128
PASSES = 128, 16  # of a path-traced map, and the samples of every texel in each
SUN = (0.35, 0.55, 0.75)
GROUND = np.array([0.21, 0.19, 0.16])  # albedo
SUN_CELLS = 96  # places per side of a texel: the sun is 0.5° wide, a texel 1.4°
# Of the compass: the colour of each side of the world, the radiance of the white column and of the
# letters, and the side of the cube's faces [pixels]
COLOURS = {
    "+x": (0.8, 0.1, 0.1),
    "-x": (0.1, 0.7, 0.7),
    "+y": (0.1, 0.65, 0.1),
    "-y": (0.7, 0.1, 0.7),
    "+z": (0.12, 0.2, 0.9),
    "-z": (0.8, 0.7, 0.1),
}
MARK = 3.0
FACE = 256


def sky(height=HEIGHT):
    """A clear sky in the afternoon, above ground that scatters its light evenly."""
    import mitsuba as mi

    # `sunsky` has z up: (x, y, z) of the map is (x, -z, y) there
    x, y, z = SUN
    emitter = mi.load_dict({"type": "sunsky", "sun_direction": [x, -z, y], "turbidity": 3.0})
    rgb = _mean_over_cells(lambda d: _emitted(emitter, d[:, [0, 2, 1]] * [1, -1, 1]), height)
    up = pixel_directions(height, 2 * height)[..., 1:2]
    cells = pixel_solid_angles(height, 2 * height)[..., None]
    illuminance = (rgb * cells * up.clip(0)).sum(axis=(0, 1))
    below = np.clip(-up * height / np.pi + 0.5, 0, 1)  # share of the cell
    return rgb + below * GROUND * illuminance / np.pi


def studio(height=HEIGHT, passes=PASSES):
    """A dark studio: a large softbox, a strip, a round one above, and a warm one behind."""
    at = _at()
    walls = _box((-4, 0, -4), (4, 4, 4), dict.fromkeys("xXYzZ", 0.06) | {"y": 0.16})
    lights = {
        "key": _softbox((-2.2, 2.3, 1.9), (0, 1.2, 0), (1.1, 0.8), (16, 15.2, 14)),
        "rim": _softbox((2.6, 1.7, 0.3), (0, 1.3, 0), (0.16, 1.2), (17, 18.2, 20)),
        "behind": _softbox((0.9, 2.4, -3.2), (0, 1.2, 0), (0.5, 0.35), (20, 13, 7)),
        "above": {
            "type": "disk",
            "to_world": at.translate([1.3, 3.9, -0.9]).rotate([1, 0, 0], 90).scale(0.5),
            "emitter": _area((5, 5.2, 5.5)),
        },
    }
    return _path_trace({**walls, **lights}, (0, 1.2, 0), height, passes)


def room(height=HEIGHT, passes=PASSES):
    """A living room by day: a window with sky above a garden, a lamp, coloured things."""
    at = _at()
    colours = {"x": (0.7, 0.66, 0.58), "X": (0.7, 0.66, 0.58), "Y": 0.8, "z": (0.25, 0.42, 0.5)}
    walls = _box((-2.4, 0, -2.0), (2.4, 2.6, 2.0), colours | {"Z": (0.7, 0.66, 0.58)})
    floor = {
        "type": "rectangle",
        "to_world": at.rotate([1, 0, 0], -90).scale([2.4, 2.0, 1]),
        "bsdf": {
            "type": "diffuse",
            "reflectance": {
                "type": "checkerboard",
                "color0": _rgb((0.34, 0.2, 0.11)),
                "color1": _rgb((0.42, 0.27, 0.15)),
                "to_uv": at.scale([10, 4, 1]),
            },
        },
    }
    sky, garden, frame = (4.2, 5.2, 6.6), (0.7, 0.9, 0.35), (0.85, 0.85, 0.82)
    window = {
        "sky": _pane((0.2, 1.75, 1.97), (0.9, 0.45), sky),
        "garden": _pane((0.2, 1.1, 1.97), (0.9, 0.2), garden),
        "post": _block((0.2, 1.55, 1.94), (0.05, 0.65, 0.03), frame),
        "bar": _block((0.2, 1.3, 1.94), (0.9, 0.04, 0.03), frame),
        "sill": _block((0.2, 0.87, 1.88), (1.0, 0.03, 0.12), frame),
    }
    things = {
        "lamp": {
            "type": "sphere",
            "center": [-1.5, 1.6, -1.3],
            "radius": 0.11,
            "emitter": _area((62, 44, 24)),
        },
        "stand": _block((-1.5, 0.75, -1.3), (0.02, 0.74, 0.02), (0.1, 0.1, 0.1)),
        "sofa": _block((1.75, 0.25, -0.3), (0.5, 0.25, 1.0), (0.5, 0.07, 0.06)),
        "back": _block((2.15, 0.5, -0.3), (0.12, 0.5, 1.0), (0.5, 0.07, 0.06)),
        "table": _block((0.1, 0.4, -0.9), (0.6, 0.03, 0.35), (0.3, 0.17, 0.08)),
        "bowl": {
            "type": "sphere",
            "center": [0.2, 0.58, -0.9],
            "radius": 0.15,
            "bsdf": {"type": "diffuse", "reflectance": _rgb((0.75, 0.45, 0.06))},
        },
        "picture": _block((-2.38, 1.5, 0.2), (0.02, 0.4, 0.6), (0.12, 0.3, 0.16)),
        "door": _block((-0.9, 1.0, -1.98), (0.42, 1.0, 0.03), (0.55, 0.5, 0.42)),
    }
    return _path_trace({**walls, "floor": floor, **window, **things}, (0, 1.3, 0), height, passes)


def compass(height=HEIGHT):
    """A map that shows which way a program turns, mirrors and shifts its environments.

    Every side of the world has its own colour and its name in it, legible from inside: +x red and
    -x cyan, +y green and -y magenta, +z blue and -z yellow. The first column of the picture is
    white and the last black, so that the seam between them is visible to half a pixel.
    """
    # right, left, up, down, ahead, back of an observer who looks along +z
    faces = np.concatenate([_face(side) for side in ("-x", "+x", "+y", "-y", "+z", "-z")], axis=1)
    source, target = parse_convention("strip:-x+y+z"), parse_convention("mitsuba")
    rgb = resample(faces, source, target, height)
    rgb[:, 0], rgb[:, -1] = MARK, 0
    return rgb


def _face(side):
    import matplotlib as mpl
    from PIL import Image, ImageDraw, ImageFont

    picture = Image.new("L", (FACE, FACE))
    file = Path(mpl.get_data_path(), "fonts/ttf/DejaVuSans-Bold.ttf")  # comes with matplotlib
    font = ImageFont.truetype(str(file), FACE // 3)
    name = side.replace("-", "\N{MINUS SIGN}")
    ImageDraw.Draw(picture).text((FACE / 2, FACE / 2), name, 255, font, "mm")
    share = np.asarray(picture)[..., None] / 255
    return (1 - share) * np.array(COLOURS[side]) + share * MARK


MAPS = {make.__name__: make for make in (studio, sky, room, compass)}


def _mean_over_cells(radiance, height):
    """The mean over every texel of `radiance`, a function of directions (n, 3)."""
    offsets = (np.arange(4) + 0.5) / 4 - 0.5
    cells = [
        pixel_directions(height, 2 * height, dx, dy).reshape(-1, 3)
        for dx in offsets
        for dy in offsets
    ]
    rgb = np.mean([radiance(cell) for cell in cells], axis=0)
    # again, more finely, where the sun may be
    sun = np.array(SUN) / np.linalg.norm(SUN)
    near = np.flatnonzero(
        pixel_directions(height, 2 * height).reshape(-1, 3) @ sun > np.cos(np.radians(3))
    )
    offsets = (np.arange(SUN_CELLS) + 0.5) / SUN_CELLS - 0.5
    total = np.zeros((len(near), 3))
    for dx in offsets:
        cells = [
            pixel_directions(height, 2 * height, dx, dy).reshape(-1, 3)[near] for dy in offsets
        ]
        total += radiance(np.concatenate(cells)).reshape(SUN_CELLS, -1, 3).sum(axis=0)
    rgb[near] = total / SUN_CELLS**2
    return rgb.reshape(height, 2 * height, 3)


def _emitted(emitter, towards):
    import mitsuba as mi

    si = mi.SurfaceInteraction3f()
    si.wi = -mi.Vector3f(towards.T.astype(np.float32))
    return np.array(emitter.eval(si)).T


def _path_trace(things, eye, height, passes):
    """The light that arrives at `eye` from all directions."""
    import drjit as dr
    import mitsuba as mi

    scene = mi.load_dict({"type": "scene", **things})
    integrator = mi.load_dict({"type": "path", "max_depth": 8, "rr_depth": 4})
    sampler = mi.load_dict({"type": "independent"})
    random = np.random.default_rng(0)
    total = np.zeros((height * 2 * height, 3))
    count, samples = passes
    texels = len(total)
    for seed in range(count):
        offsets = random.uniform(-0.5, 0.5, (2, samples, height, 2 * height))
        towards = pixel_directions(height, 2 * height, *offsets)
        sampler.seed(seed, texels * samples)
        ray = mi.Ray3f(
            o=mi.Point3f(*eye), d=mi.Vector3f(towards.reshape(-1, 3).T.astype(np.float32))
        )
        radiance, _, _ = integrator.sample(scene, sampler, mi.RayDifferential3f(ray))
        dr.eval(radiance)
        total += np.array(radiance).T.reshape(samples, texels, 3).sum(axis=0, dtype=float)
    return (total / (count * samples)).reshape(height, 2 * height, 3)


def _box(low, high, colours):
    """The inner sides of a box; `colours`: by the axis across the side, a capital at its end."""
    at, (low, high) = _at(), np.array([low, high], float)
    middle, half = (low + high) / 2, (high - low) / 2
    sides = {}
    for letter, colour in colours.items():
        axis, end = "xyz".index(letter.lower()), letter.isupper()
        place = middle.copy()
        place[axis] = (high if end else low)[axis]
        up = [0, 0, 1] if axis == 1 else [0, 1, 0]
        across = {0: (half[2], half[1]), 1: (half[0], half[2]), 2: (half[0], half[1])}[axis]
        facing = at.look_at(list(place), list(np.where(np.arange(3) == axis, middle, place)), up)
        sides[f"side_{letter}"] = {
            "type": "rectangle",
            "to_world": facing @ at.scale([*across, 1]),
            "bsdf": {"type": "diffuse", "reflectance": _rgb(np.broadcast_to(colour, 3))},
        }
    return sides


def _softbox(place, target, halves, radiance):
    at = _at()
    return {
        "type": "rectangle",
        "to_world": at.look_at(list(place), list(target), [0, 1, 0]) @ at.scale([*halves, 1]),
        "bsdf": {"type": "diffuse", "reflectance": _rgb((0.02, 0.02, 0.02))},
        "emitter": _area(radiance),
    }


def _pane(place, halves, radiance):
    """A part of the window: it lights the room, towards -z."""
    towards = np.subtract(place, (0, 0, 1))
    return _softbox(place, towards, halves, radiance)


def _block(middle, halves, colour):
    at = _at()
    return {
        "type": "cube",
        "to_world": at.translate(list(middle)).scale(list(halves)),
        "bsdf": {"type": "diffuse", "reflectance": _rgb(colour)},
    }


def _area(radiance):
    return {"type": "area", "radiance": _rgb(radiance)}


def _rgb(values):
    return {"type": "rgb", "value": [float(v) for v in values]}


def _at():
    import mitsuba as mi

    return mi.ScalarTransform4f()


if __name__ == "__main__":
    import mitsuba as mi

    mi.set_variant("llvm_ad_rgb")
    for name in sys.argv[1:] or MAPS:
        rgb = MAPS[name]()
        path = write_map(rgb, Path(__file__).with_name(f"{name}.exr"))
        checksum = hashlib.sha256(path.read_bytes()).hexdigest()
        bright = luminance(rgb)
        print(f"{path.name}: {path.stat().st_size:,} bytes, mean {bright.mean():.3g}, ", end="")
        print(f"max {bright.max():.4g}, sha256 {checksum}")
