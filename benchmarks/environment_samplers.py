"""Samplers of environment maps beside Mitsuba's `envmap`: noise, time, memory, build, gradient.

python benchmarks/environment_samplers.py [MAP ...]    # writes docs/environment_samplers.md

A sky with a sun is made by the program; maps on the command line come besides. All ratios are of
one run; times are of the processor, the least of several. The samplers take turns, each alone, and
the whole is repeated, so that the page can say how far its figures may be off. Some ten minutes.
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
    "blocks, `steps`": BLOCKS | {"distribution": "steps"},
    "blocks, `hyperbolic`": BLOCKS | {"distribution": "hyperbolic"},
    "`cdf`": OTHERS | {"sampler": "cdf"},
    "`mip`": OTHERS | {"sampler": "mip"},
    "`alias`": OTHERS | {"sampler": "alias"},
    "blocks, compensated": BLOCKS | {"compensated": True},
    "`alias`, compensated": OTHERS | {"sampler": "alias", "compensated": True},
}
SIZE, SPP = 24, 36
PICTURES = 6  # whose variance is taken in a repeat, for each of Mitsuba's two samplers
ROUNDS = 2  # of which the least time is taken, in a repeat

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


def sky():
    """A clouded sky with a sun over dark ground, 1024 × 2048, as a `mi.Bitmap`."""
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


def maps(files):
    """Name → `mi.Bitmap` in floats."""
    import mitsuba as mi

    kind = mi.Bitmap.PixelFormat.RGB, mi.Struct.Type.Float32, False
    return {"sky": sky()} | {Path(f).stem: mi.Bitmap(str(f)).convert(*kind) for f in files}


def scene(emitter, sampler="independent", integrator="path"):
    """A matt and a glossy ball on ground that fills the picture."""
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


def noise(emitter, sampler, repeat):
    """The variance of pixels over the square of their means, in the mean over the picture."""
    import mitsuba as mi

    loaded = scene(emitter, sampler)
    seeds = range(PICTURES * repeat, PICTURES * (repeat + 1))
    pictures = (np.array(mi.render(loaded, spp=SPP, seed=seed)) for seed in seeds)
    found = np.array([luminance(picture) for picture in pictures])
    return float((found.var(axis=0, ddof=1) / found.mean(axis=0) ** 2).mean())


def least_seconds(function, rounds=ROUNDS):
    """The least processor time of a function, after a first call that compiles its kernels."""
    function(0)
    seconds = []
    for round_ in range(rounds):
        began = time.process_time()
        function(round_)
        seconds.append(time.process_time() - began)
    return min(seconds)


def picture(emitter):
    """A function that renders a picture."""
    import mitsuba as mi

    loaded = scene(emitter)
    return lambda seed: np.array(mi.render(loaded, spp=8 * SPP, seed=seed))


def gradient(emitter):
    """A function that renders a picture and sums the derivatives of its mean by the map.

    By a leaf of our own: where that of Mitsuba's `envmap` is enabled, its first gradient is 0.
    """
    import drjit as dr
    import mitsuba as mi

    loaded = scene(emitter, integrator="prb")
    parameters = mi.traverse(loaded)
    key = next(k for k in parameters.keys() if k.endswith("data"))  # noqa: SIM118
    leaf = mi.TensorXf(dr.detach(parameters[key]))
    dr.enable_grad(leaf)
    parameters[key] = leaf
    parameters.update()

    def derivatives(seed):
        dr.set_grad(leaf, 0)
        mean = dr.mean(mi.render(loaded, parameters, spp=SPP, seed=seed), axis=None)
        dr.backward(mean, flags=dr.ADFlag.ClearInterior)  # the edges serve the next picture too
        return np.array(dr.grad(leaf), float).sum()

    return derivatives


def numpy_cdf(power):
    """A 2-D CDF of cells: their sums along rows, and those of the rows."""
    rows = np.cumsum(power, axis=1)
    totals = np.cumsum(rows[:, -1])
    return rows / np.maximum(rows[:, -1:], 1e-30), totals / totals[-1]


def measure(bitmap, repeat):
    """Sampler → its figures on a map; `envmap`'s are 1 where they are ratios."""
    pixels = luminance(np.array(bitmap, float))
    power = cell_power(pixels)
    found = {n: figures(entries | {"bitmap": bitmap}, repeat) for n, entries in SAMPLERS.items()}
    first = found["`envmap`"]
    cdf = least_seconds(lambda _: numpy_cdf(power))
    tables = {name: own["memory"] for name, own in found.items()}
    tables["`envmap`"] = tables["`mip`"]  # it has the same
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


def figures(entries, repeat):
    """One emitter's own figures. Kernels contain every emitter that is alive, so it is alone."""
    import mitsuba as mi

    gc.collect()
    emitter = mi.load_dict(entries)
    derivatives = gradient(emitter)
    seeds = range(ROUNDS * repeat, ROUNDS * (repeat + 1))
    ours = hasattr(emitter, "points")
    bright = luminance(np.array(entries["bitmap"], float))
    return {
        "noise": noise(emitter, "independent", repeat),
        "jittered": noise(emitter, "multijitter", repeat),
        "time": least_seconds(picture(emitter)),
        "build": least_seconds(lambda _: emitter.make_sampler(bright)) if ours else np.nan,
        "load": least_seconds(lambda _: mi.load_dict(entries)),
        "memory": emitter.map_sampler.nbytes if ours else np.nan,
        "sum": sum(derivatives(seed) for seed in seeds),
        "backward": least_seconds(derivatives),
    }


def table(head, rows):
    """A Markdown table."""
    lines = ["| " + " | ".join(cells) + " |" for cells in (head, ["---"] * len(head), *rows)]
    return "\n".join(lines) + "\n"


def number(value):
    """Three digits, nothing for what was not measured."""
    return "" if np.isnan(value) else f"{value:.2f}" if value < 10 else f"{value:.0f}"


def page(found, sizes):
    """The page, of the repeats' figures map → sampler → column → numbers (repeats,)."""
    columns = list(next(iter(next(iter(found.values())).values())))
    repeats = len(found[next(iter(found))]["blocks"]["time"])
    of_column = {
        c: np.array([[by[s][c] for by in found.values()] for s in SAMPLERS]) for c in columns
    }  # (samplers, maps, repeats)
    means = {c: values.mean(axis=2) for c, values in of_column.items()}
    off = {c: standard_error(values) for c, values in of_column.items()}

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
    rows = [[name, *map(number, row)] for name, row in zip(SAMPLERS, np.array(over).T, strict=True)]
    rows.append(["±", *(percent(value / np.sqrt(len(found))) for value in off.values())])
    text += table(["", *columns], rows)
    of = {
        "Noise": "noise",
        "Noise with stratified numbers": "noise, multijitter",
        "Time": "time",
        "Build, over NumPy's CDF": "build",
        "Memory, in per cent of the map": "memory [%]",
        "Gradient's sum": "gradient's sum",
    }
    for title, column in of.items():
        rows = [[s, *map(number, row)] for s, row in zip(SAMPLERS, means[column], strict=True)]
        text += f"\n## {title}\n\nEach ± {percent(off[column])}.\n\n" + table(["", *found], rows)
    return text + TAIL


def standard_error(values):
    """Of means over repeats, relative; pooled over samplers and maps (samplers, maps, repeats)."""
    relative = values.std(axis=2, ddof=1) / values.mean(axis=2)
    relative = relative[np.isfinite(relative)]
    varying = relative[relative > 0]  # `envmap`'s own ratios are 1 each time
    return np.sqrt((varying**2).mean() / values.shape[2]) if len(varying) else 0.0


def percent(value):
    """A share as per cent."""
    return f"{100 * value:.1f} %"


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("maps", nargs="*", metavar="MAP", help="latitude over longitude")
    parser.add_argument("--repeats", type=int, default=2, help="2 or more (default: 2)")
    arguments = parser.parse_args()
    if arguments.repeats < 2:
        parser.error("--repeats: give 2 or more; one measurement has no known error.")

    llvm.use_variant()
    assert bk.check(make_example("kdtree_envmap"), only=["weights"])  # and Mitsuba is awake
    out = Console(stderr=True)
    found, sizes = {}, {}
    with threads.use_two_threads():
        for name, bitmap in maps(arguments.maps).items():
            out.print(f"{name} ...")
            repeats = [measure(bitmap, repeat) for repeat in range(arguments.repeats)]
            found[name], sizes[name] = joined(repeats), tuple(bitmap.size())
    PAGE.write_text(page(found, sizes), encoding="utf-8")
    out.print(f"written: {PAGE}")
    return 0


def joined(repeats):
    """Sampler → column → numbers (repeats,), of the figures of each repeat."""
    return {
        name: {column: np.array([r[name][column] for r in repeats]) for column in figures}
        for name, figures in repeats[0].items()
    }


if __name__ == "__main__":
    sys.exit(main())
