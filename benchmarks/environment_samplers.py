"""Compares samplers of environment maps with Mitsuba's `envmap`: noise, time, memory, gradient.

python benchmarks/environment_samplers.py [MAP ...]    # writes docs/environment_samplers.md

The program generates a sky with a sun; maps on the command line are used as well. All ratios are of
one run; times are processor times, the least of several. The samplers take turns, each alone, and
the whole is repeated, so that the page can state the uncertainty of its numbers. It takes some ten
minutes.
"""

import argparse
import gc
import sys
import time
from pathlib import Path

import numpy as np
from rich.console import Console

import brdfkit as bk
from brdfkit.checks.plugin_subject import make_example
from brdfkit.core.colours import luminance
from brdfkit.core.jit import llvm, threads
from brdfkit.lighting.sampling.power_map import cell_power

PAGE = Path(__file__).parents[1] / "docs" / "environment_samplers.md"
BLOCKS, OTHERS = {"type": "kdtree_envmap"}, {"type": "sampled_envmap"}
SAMPLERS = {
    "`envmap`": {"type": "envmap"},
    "blocks": BLOCKS,
    "blocks, `lookup=tree`": BLOCKS | {"lookup": "tree"},
    "blocks, `lookup=grid`": BLOCKS | {"lookup": "grid"},
    "blocks, `criterion=sse`": BLOCKS | {"criterion": "sse"},
    "blocks, `alias`": BLOCKS | {"distribution": "alias"},
    "blocks, `steps`": BLOCKS | {"distribution": "steps"},
    "blocks, `hyperbolic`": BLOCKS | {"distribution": "hyperbolic"},
    "`cdf`": OTHERS | {"sampler": "cdf"},
    "`mip`": OTHERS | {"sampler": "mip"},
    "`alias`": OTHERS | {"sampler": "alias"},
    "blocks, compensated": BLOCKS | {"compensated": True},
    "`alias`, compensated": OTHERS | {"sampler": "alias", "compensated": True},
}
SIZE, SPP = 24, 36
# Pictures in a repeat, whose variance is computed, for each of Mitsuba's two samplers
PICTURES = 6
# Runs in a repeat, of which the least time counts
ROUNDS = 2

HEAD = """# Environment samplers

How the points of an environment map are drawn: by 4,096 blocks of a tree (`kdtree_envmap`), and by
the usual ways (`sampled_envmap`), beside Mitsuba's `envmap`, whose figures are 1. Ours share the
look-up of the radiance, so that they differ in the sampler alone.

- **Noise** is the variance of pixels at equal samples over the square of their means: a matt
  and a glossy ball on matt ground, path traced, so that light and surfaces are both sampled. Once
  with Mitsuba's sampler `independent`, once with `multijitter`, which stratifies its numbers.
- **Time** is that of such a picture, and noise × time is what an equally good one costs.
- **Build** is the time in which a sampler is made of the map's brightness, over that in which NumPy
  makes a 2-D CDF: sums along rows, and of rows. **Load** is that of the whole emitter, from pixels
  in memory, over `envmap`'s.
- **Memory** is that of the sampler's tables, in per cent of a map of three floats a pixel.
- **Gradient** is the time of a picture and its derivatives by the map (`prb`), without that of
  making the sampler anew, as an update of the map does. **Gradient's sum** is that of the
  derivatives of the mean over all texels, over `envmap`'s: 1 where they agree.

`brdfkit samplers MAP --scene MESH.obj --material NAME` compares them on a map, mesh and material of
yours.

`python benchmarks/environment_samplers.py MAP ...` makes this page anew; these maps were {maps}.
Pictures have {size} × {size} pixels of {spp} samples. Everything was measured {repeats} times:
{pictures} pictures a time for noise, the least of {rounds} times for pictures and gradients. A
figure is the mean, and **±** its standard error, pooled over samplers and maps.

"""
TAIL = """
## How to read the tables

- Blocks follow the light by straight lines within each block; `cdf` and `alias` are even between
  pixels, `mip` and `envmap` are as the map. A sun that is a few pixels wide tells them apart.
- `lookup=tree` is the form of little memory. The default stores the number of its block for every
  cell besides, which is one channel of the map.
- Stratified numbers need a sampler that keeps neighbours together, as the walk down the tree does;
  blocks sorted by probability, as closed forms need them, and alias tables do not.
- Compensation is wrong where lights alone are sampled, and so it has to be asked for.
"""


def make_sky():
    """Return a `mi.Bitmap` (1024 × 2048) of a cloudy sky with a sun over dark ground."""
    import mitsuba as mi

    v, u = np.meshgrid(np.linspace(0, 1, 1024), (np.arange(2048) + 0.5) / 2048, indexing="ij")
    random = np.random.default_rng(0)
    clouds = sum(
        np.cos(2 * np.pi * (round(k) * u + f * v) + phase) / k
        for k, f, phase in random.random((40, 3)) * [60, 60, 2 * np.pi] + [1, 0, 0]
    )
    bright = np.where(v < 0.5, 0.4 + 0.3 * v + 0.2 * clouds.clip(0, 4), 0.08)
    bright = bright * random.gamma(20, 1 / 20, bright.shape)
    colour = np.stack([0.7 * bright, 0.9 * bright, 1.2 * bright], axis=-1)
    distance = np.hypot((u - 0.3) * 2 * np.sin(np.pi * 0.2), v - 0.2) * np.pi
    sun = 2e4 * (distance < 0.0047) + 3 * np.exp(-distance / 0.05)
    return mi.Bitmap((colour + sun[..., None]).astype(np.float32))


def load_maps(files):
    """Return the maps as `mi.Bitmap` of floats, by name."""
    import mitsuba as mi

    kind = mi.Bitmap.PixelFormat.RGB, mi.Struct.Type.Float32, False
    return {"sky": make_sky()} | {Path(f).stem: mi.Bitmap(str(f)).convert(*kind) for f in files}


def make_scene(emitter, sampler="independent", integrator="path"):
    """Return a scene of a matt and a glossy ball on a ground that fills the picture."""
    import mitsuba as mi

    to = mi.ScalarTransform4f()
    camera = to.look_at([0, 6, 4], [0, 0.6, 0], [0, 1, 0])
    film = {"type": "hdrfilm", "width": SIZE, "height": SIZE, "rfilter": {"type": "box"}}
    return mi.load_dict(
        {
            "type": "scene",
            "integrator": {"type": integrator, "max_depth": 3},
            "sensor": {
                "type": "perspective",
                "fov": 35,
                "to_world": camera,
                "film": film,
                "sampler": {"type": sampler, "sample_count": SPP},
            },
            "matt": {"type": "sphere", "center": [-1.1, 1, 0]},
            "glossy": {
                "type": "sphere",
                "center": [1.1, 1, 0],
                "bsdf": {"type": "roughconductor", "alpha": 0.15},
            },
            "ground": {"type": "rectangle", "to_world": to.rotate([1, 0, 0], -90).scale(50)},
            "light": emitter,
        }
    )


def measure_noise(emitter, sampler, repeat):
    """Return the variance of pixels over their squared means, averaged over the picture."""
    import mitsuba as mi

    loaded = make_scene(emitter, sampler)
    seeds = range(PICTURES * repeat, PICTURES * (repeat + 1))
    pictures = (np.array(mi.render(loaded, spp=SPP, seed=seed)) for seed in seeds)
    found = np.array([luminance(picture) for picture in pictures])
    return float((found.var(axis=0, ddof=1) / found.mean(axis=0) ** 2).mean())


def measure_least_seconds(function, rounds=ROUNDS):
    """Return the least processor time of a function, after a first call that compiles kernels."""
    function(0)
    seconds = []
    for round_ in range(rounds):
        began = time.process_time()
        function(round_)
        seconds.append(time.process_time() - began)
    return min(seconds)


def make_picture_function(emitter):
    """Return a function of a seed that renders a picture with an emitter."""
    import mitsuba as mi

    loaded = make_scene(emitter)
    return lambda seed: np.array(mi.render(loaded, spp=8 * SPP, seed=seed))


def make_gradient_function(emitter):
    """Return a function of a seed that sums the derivatives of a picture's mean by the map.

    Gradients of the map are enabled on a new array, because the first gradient of Mitsuba's
    `envmap` is 0 if they are enabled on its own one.
    """
    import drjit as dr
    import mitsuba as mi

    loaded = make_scene(emitter, integrator="prb")
    parameters = mi.traverse(loaded)
    key = next(k for k in parameters.keys() if k.endswith("data"))  # noqa: SIM118
    leaf = mi.TensorXf(dr.detach(parameters[key]))
    dr.enable_grad(leaf)
    parameters[key] = leaf
    parameters.update()

    def derivatives(seed):
        dr.set_grad(leaf, 0)
        mean = dr.mean(mi.render(loaded, parameters, spp=SPP, seed=seed), axis=None)
        dr.backward(mean, flags=dr.ADFlag.ClearInterior)  # keep the graph for the next picture
        return np.array(dr.grad(leaf), float).sum()

    return derivatives


def make_numpy_cdf(power):
    """Return a 2-D cumulative distribution: sums of cells along rows, and sums of the rows."""
    rows = np.cumsum(power, axis=1)
    totals = np.cumsum(rows[:, -1])
    return rows / np.maximum(rows[:, -1:], 1e-30), totals / totals[-1]


def measure_samplers(bitmap, repeat):
    """Return the measurements of each sampler on a map, as ratios to `envmap` where possible."""
    pixels = luminance(np.array(bitmap, float))
    power = cell_power(pixels)
    found = {
        n: measure_sampler(entries | {"bitmap": bitmap}, repeat) for n, entries in SAMPLERS.items()
    }
    first = found["`envmap`"]
    cdf = measure_least_seconds(lambda _: make_numpy_cdf(power))
    tables = {name: own["memory"] for name, own in found.items()}
    tables["`envmap`"] = tables["`mip`"]  # its tables are equal to those of `mip`
    noise_x_time = first["noise"] * first["time"]
    return {
        name: {
            "noise": own["noise"] / first["noise"],
            "time": own["time"] / first["time"],
            "noise × time": own["noise"] * own["time"] / noise_x_time,
            "noise, multijitter": own["jittered"] / first["jittered"],
            "gain by multijitter": own["noise"] / own["jittered"],
            "build": own["build"] / cdf,
            "load": own["load"] / first["load"],
            "memory [%]": 100 * tables[name] / (12 * pixels.size),
            "gradient": own["backward"] / first["backward"],
            "gradient's sum": own["sum"] / first["sum"],
        }
        for name, own in found.items()
    }


def measure_sampler(entries, repeat):
    """Return the measurements of one emitter.

    No other emitter exists at that time, because kernels would contain it, too.
    """
    import mitsuba as mi

    gc.collect()
    emitter = mi.load_dict(entries)
    derivatives = make_gradient_function(emitter)
    seeds = range(ROUNDS * repeat, ROUNDS * (repeat + 1))
    ours = hasattr(emitter, "map_sampler")
    bright = luminance(np.array(entries["bitmap"], float))
    return {
        "noise": measure_noise(emitter, "independent", repeat),
        "jittered": measure_noise(emitter, "multijitter", repeat),
        "time": measure_least_seconds(make_picture_function(emitter)),
        "build": measure_least_seconds(lambda _: emitter.make_sampler(bright)) if ours else np.nan,
        "load": measure_least_seconds(lambda _: mi.load_dict(entries)),
        "memory": emitter.map_sampler.nbytes if ours else np.nan,
        "sum": sum(derivatives(seed) for seed in seeds),
        "backward": measure_least_seconds(derivatives),
    }


def make_table(head, rows):
    """Return a Markdown table; `head`: texts of its columns, `rows`: texts of cells."""
    lines = ["| " + " | ".join(cells) + " |" for cells in (head, ["---"] * len(head), *rows)]
    return "\n".join(lines) + "\n"


def format_number(value):
    """Return a number as text with three digits; "" for NaN, a missing measurement."""
    return "" if np.isnan(value) else f"{value:.2f}" if value < 10 else f"{value:.0f}"


def make_page(found, sizes):
    """Return the text of the page.

    `found`: numbers (repeats,) by map, sampler and column; `sizes`: sizes of the maps [pixels].
    """
    columns = list(next(iter(next(iter(found.values())).values())))
    repeats = len(found[next(iter(found))]["blocks"]["time"])
    of_column = {
        c: np.array([[by[s][c] for by in found.values()] for s in SAMPLERS]) for c in columns
    }  # (samplers, maps, repeats)
    means = {c: values.mean(axis=2) for c, values in of_column.items()}
    off = {c: estimate_standard_error(values) for c, values in of_column.items()}

    text = HEAD.format(
        maps=", ".join(f"{n} ({w} × {h})" for n, (w, h) in sizes.items()),
        size=SIZE,
        spp=SPP,
        repeats=repeats,
        pictures=PICTURES,
        rounds=ROUNDS,
    )
    text += (
        "## In the mean over the maps\n\nGeometric means of ratios; per cent are plain means.\n\n"
    )
    over = [v.mean(axis=1) if "[%]" in c else np.exp(np.log(v).mean(1)) for c, v in means.items()]
    rows = [
        [name, *map(format_number, row)]
        for name, row in zip(SAMPLERS, np.array(over).T, strict=True)
    ]
    rows.append(["±", *(format_percent(value / np.sqrt(len(found))) for value in off.values())])
    text += make_table(["", *columns], rows)
    of = {
        "Noise": "noise",
        "Noise with stratified numbers": "noise, multijitter",
        "Time": "time",
        "Build, over NumPy's CDF": "build",
        "Memory, in per cent of the map": "memory [%]",
        "Gradient's sum": "gradient's sum",
    }
    for title, column in of.items():
        rows = [
            [s, *map(format_number, row)] for s, row in zip(SAMPLERS, means[column], strict=True)
        ]
        text += f"\n## {title}\n\nEach ± {format_percent(off[column])}.\n\n" + make_table(
            ["", *found], rows
        )
    return text + TAIL


def estimate_standard_error(values):
    """Return the relative standard error of means over repeats, pooled over samplers and maps.

    `values`: measurements (samplers, maps, repeats).
    """
    relative = values.std(axis=2, ddof=1) / values.mean(axis=2)
    relative = relative[np.isfinite(relative)]
    varying = relative[relative > 0]  # the ratios of `envmap` to itself are always 1
    return np.sqrt((varying**2).mean() / values.shape[2]) if len(varying) else 0.0


def format_percent(value):
    """Return a share as text in per cent."""
    return f"{100 * value:.1f} %"


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("maps", nargs="*", metavar="MAP", help="latitude over longitude")
    parser.add_argument("--repeats", type=int, default=2, help="2 or more (default: 2)")
    arguments = parser.parse_args()
    if arguments.repeats < 2:
        parser.error("--repeats: give 2 or more; one measurement has no known error.")

    llvm.use_variant()
    assert bk.check(
        make_example("kdtree_envmap"), only=["weights"]
    )  # the check also initialises Mitsuba
    out = Console(stderr=True)
    found, sizes = {}, {}
    with threads.use_two_threads():
        for name, bitmap in load_maps(arguments.maps).items():
            out.print(f"{name} ...")
            repeats = [measure_samplers(bitmap, repeat) for repeat in range(arguments.repeats)]
            found[name], sizes[name] = join_repeats(repeats), tuple(bitmap.size())
    PAGE.write_text(make_page(found, sizes), encoding="utf-8")
    out.print(f"written: {PAGE}")
    return 0


def join_repeats(repeats):
    """Return the measurements of all repeats as arrays (repeats,), by sampler and column."""
    return {
        name: {column: np.array([r[name][column] for r in repeats]) for column in figures}
        for name, figures in repeats[0].items()
    }


if __name__ == "__main__":
    sys.exit(main())
