"""`compare_samplers`: finds the sampler of an environment map that needs least time for a picture.

A sampler chooses random directions in proportion to the light of the map.
"""

from __future__ import annotations

import time
from pathlib import Path
from typing import Any

import numpy as np

from brdfkit.core.arguments import to_whole_number
from brdfkit.core.array_types import FloatArray, MitsubaObject
from brdfkit.core.colours import luminance
from brdfkit.core.errors import BrdfkitError
from brdfkit.core.jit.threads import in_turn
from brdfkit.core.progress_bar import Progress
from brdfkit.materials import resolve
from brdfkit.mitsuba_bridge.properties.picture_file import load_by_mitsuba
from brdfkit.rendering.progressive import to_rgb
from brdfkit.rendering.sampler_comparison import SamplerComparison
from brdfkit.rendering.scene_input.arguments import load_mitsuba
from brdfkit.rendering.scene_input.environment import describe_environment, replace_light
from brdfkit.rendering.scene_input.loading import find_scene, find_scene_suffix
from brdfkit.rendering.scene_input.material import load_material

SAMPLERS: dict[str, dict[str, Any]] = {
    "envmap": {"type": "envmap"},
    "blocks": {"type": "kdtree_envmap"},
    "blocks, compensated": {"type": "kdtree_envmap", "compensated": True},
    "cdf": {"type": "sampled_envmap", "sampler": "cdf"},
    "alias": {"type": "sampled_envmap", "sampler": "alias"},
    "alias, compensated": {"type": "sampled_envmap", "sampler": "alias", "compensated": True},
}
SPP, SIZE, ROUNDS, FEWEST_ROUNDS = 16, 96, 10, 3
# Smallest brightness by which the noise of a pixel is divided, as a share of the mean brightness
DARK = 0.01


def compare_samplers(
    environment: str | Path,
    material: resolve.MaterialLike = "plaster",
    *,
    scene: str | Path = "ball",
    rounds: int = ROUNDS,
    spp: int = SPP,
    size: int = SIZE,
    seed: int = 0,
    progress: Progress | None = None,
) -> SamplerComparison:
    """Measure which sampler of an environment map needs least time for an equally good picture.

    The pictures are path-traced, so light and surfaces are both sampled. In each round every
    sampler renders two pictures with different seeds, which are the same for all samplers; half of
    their squared difference estimates the variance of a pixel. The order of the samplers changes
    from round to round, so that other work on the machine disturbs all alike. After Ctrl-C the
    finished rounds count, if there are three or more.

    Parameters
    ----------
    environment : str or Path
        The environment map: a known name or a file, as for `render`.
    material : Measured, Fit, Model, str, Path or dict, default "plaster"
        The material that is lit.
    scene : str or Path, default "ball"
        The name of a scene without lamps of its own, or a mesh (.obj, .ply; "FILE.obj#z" where z
        points up).
    rounds : int, default 10
        Number of repetitions, at least 3.
    spp : int, default 16
        Samples per pixel.
    size : int, default 96
        Side of the pictures [pixels].
    seed : int, default 0
        Seed of the first picture.
    progress : callable, optional
        Called with (done, total) after each round.

    Returns
    -------
    SamplerComparison
        Noise, time and cost of each sampler; prints as a table, with the sampler to take.

    Raises
    ------
    BrdfkitError
        For a map, material or scene that cannot be rendered, and fewer than three rounds.

    Examples
    --------
    >>> print(compare_samplers("probe.exr", "car_paint", scene="teapot.obj"))    # doctest: +SKIP
    """
    rounds = to_whole_number("rounds", rounds, least=FEWEST_ROUNDS)
    spp, size = to_whole_number("spp", spp, least=1), to_whole_number("size", size, least=1)
    seed = to_whole_number("seed", seed, least=0)
    if not isinstance(scene, str | Path):
        raise BrdfkitError(f"scene = {scene!r:.60} should be a scene's name or a mesh's file.")
    load_mitsuba()
    found = resolve.to_material(material)
    noise, seconds = _measure_noise_and_time(
        environment, found, scene, rounds, spp, size, seed, progress
    )
    where = str(Path(str(environment)).name), found.name, Path(str(scene)).name
    return SamplerComparison(*where, noise, seconds, rounds)


@in_turn
def _measure_noise_and_time(
    environment: str | Path,
    material: resolve.Material,
    scene: str | Path,
    rounds: int,
    spp: int,
    size: int,
    seed: int,
    progress: Progress | None,
) -> tuple[dict[str, FloatArray], dict[str, FloatArray]]:
    """Return the noise and the time [s] of each sampler in each finished round, (rounds,) by name.

    They are the attributes `noise` and `seconds` of `SamplerComparison`.
    """
    scenes = _load_scene_for_each_sampler(environment, material, scene, size)
    names = list(scenes)
    for loaded in scenes.values():  # the first rendering compiles, which should not be timed
        _render_luminance(loaded, spp, seed)
    pairs: list[dict[str, Any]] = []
    seconds: list[dict[str, float]] = []
    try:
        for r in range(rounds):
            pair: dict[str, Any] = {}
            took: dict[str, float] = {}
            for name in names[r % len(names) :] + names[: r % len(names)]:
                pair[name], each = [], []
                for k in (0, 1):
                    start = time.process_time()
                    pair[name].append(_render_luminance(scenes[name], spp, seed + 2 * r + k))
                    each.append(time.process_time() - start)
                took[name] = min(each)  # other programs may have delayed the slower rendering
            pairs.append(pair)
            seconds.append(took)
            if progress:
                progress(r + 1, rounds)
    except KeyboardInterrupt:
        if len(seconds) < FEWEST_ROUNDS:
            raise
    pairs = pairs[: len(seconds)]
    mean = np.mean([pictures for pair in pairs for pictures in pair.values()], axis=(0, 1))
    scale = np.maximum(mean, DARK * mean.mean())
    noise = {
        n: np.array([np.mean((p[n][0] - p[n][1]) ** 2 / 2 / scale**2) for p in pairs])
        for n in names
    }
    return noise, {n: np.array([took[n] for took in seconds]) for n in names}


def _load_scene_for_each_sampler(
    environment: str | Path, material: resolve.Material, scene: str | Path, size: int
) -> dict[str, MitsubaObject]:
    """Load the same scene with each of the samplers; return `mitsuba.Scene`s by sampler name."""
    import mitsuba as mi

    light, is_mesh = describe_environment(environment), bool(find_scene_suffix(scene))
    shown = load_material(material.scene_dict(), str(material.name), both_sides=is_mesh)
    made, scenes = find_scene(scene)(shown, (size, size)), {}
    for name, sampler in SAMPLERS.items():
        scenes[name] = load_by_mitsuba(mi.load_dict, replace_light(light | sampler, made), name)
    return scenes


def _render_luminance(loaded: MitsubaObject, spp: int, seed: int) -> FloatArray:
    """Render a picture of a `mitsuba.Scene`, and return its luminance (height, width)."""
    import mitsuba as mi

    return luminance(to_rgb(mi.render(loaded, spp=spp, seed=seed)).astype(float))
