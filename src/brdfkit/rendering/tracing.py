"""Path-traces several scenes together, in passes that render every picture once."""

from __future__ import annotations

import inspect
import sys
import time
from collections import defaultdict
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from math import isqrt
from typing import Any

import numpy as np
from numpy.typing import NDArray

from brdfkit.core.array_types import BoolArray, MitsubaObject
from brdfkit.images.errors.noise import Accumulated, Halves, estimate_samples
from brdfkit.images.errors.psnr import psnr
from brdfkit.rendering.progressive import Progressive

# Default limit of the samples per pixel in one pass. It is a power of two, so that one thread
# renders all samples of a pixel, in a fixed order
PASS = 16
RAYS = 2**22  # largest number of camera rays in a pass, so that it needs little memory and time


@dataclass(frozen=True)
class Traced:
    """The result of `trace_scenes`: the pictures by name, and how they were rendered.

    `first`: the accumulated passes of the first picture, which is the reference.
    `spp`, `requested`: numbers of samples per pixel that were reached and requested.
    `seconds`: wall-clock time of the rendering.
    """

    pictures: dict[str, np.ndarray]
    first: Accumulated
    spp: int
    requested: int
    seconds: float


def trace_scenes(
    loaded: Mapping[str, MitsubaObject],
    spp: int,
    seed: int,
    progress: Callable[..., object] | None,
    noise_floor: float | None = None,
    mask: BoolArray | None = None,
    limit: float | None = None,
    most: int | None = None,
) -> Traced:
    """Path-trace scenes, given by name, with `spp` samples per pixel; the first is the reference.

    Each pass renders every picture once, with at most `most` samples per pixel (default PASS). If
    `spp` is at least 2, there are at least two passes, from which the noise is estimated. With a
    `noise_floor` [dB], measured over the `mask`, the passes end as soon as it is reached. With a
    `limit` [s], they end after the pass in which this time is over. In both cases `spp` is the
    largest number of samples.

    After Ctrl-C the pictures contain the passes that all of them have; if there is none,
    KeyboardInterrupt is raised. `progress` is called with (done, total) after each picture of a
    pass. If it has a parameter `pictures`, it also receives a function that returns the pictures so
    far.
    """
    pixels = max(map(count_pixels, loaded.values()))
    passes, growing = plan_passes(spp, pixels, most), Progressive(loaded, seed)
    pictures = (
        (number, name, growing.generate(name, count))
        for number, count in enumerate(passes)
        for name in loaded
    )
    return accumulate_passes(growing, passes, pictures, progress, noise_floor, mask, limit)


def count_pixels(scene: MitsubaObject) -> int:
    """Return the number of pixels of a scene's picture."""
    return int(np.prod(scene.sensors()[0].film().crop_size()))


def plan_passes(spp: int, pixels: int, most: int | None = None) -> list[int]:
    """Return the samples per pixel of each pass of a picture with a number of `pixels`.

    They are `spp` in all; `most` is as in `trace_scenes`.
    """
    return list(divide_into_passes(spp, max(1, min(most or PASS, RAYS // pixels, (spp + 1) // 2))))


def accumulate_passes(
    growing: Progressive,
    passes: Sequence[int],
    pictures: Iterable[tuple[int, str, NDArray[np.float32]]],
    progress: Callable[..., object] | None,
    noise_floor: float | None = None,
    mask: BoolArray | None = None,
    limit: float | None = None,
) -> Traced:
    """Add up `pictures`, each given as (number of the pass, name, picture), to those of `growing`.

    They may come in any order, but a pass is added when all earlier ones are, so that the result
    does not depend on it. `passes` are the samples per pixel of each. The other arguments, and what
    happens after Ctrl-C, are those of `trace_scenes`.
    """
    start = time.perf_counter()
    reference, names = next(iter(growing.accumulated)), len(growing.accumulated)
    arrived: dict[int, dict[str, NDArray[np.float32]]] = defaultdict(dict)
    finished, expected = 0, len(passes)
    keywords = _find_progress_arguments(progress, growing)
    try:
        for done, (number, name, picture) in enumerate(pictures, start=1):
            arrived[number][name] = picture
            while finished < expected and len(arrived[finished]) == names:
                growing.integrate(arrived.pop(finished), passes[finished])
                finished += 1
                halves = growing.accumulated[reference].halves
                seconds = time.perf_counter() - start
                expected = min(
                    _estimate_passes_to_noise_floor(passes, finished, halves, noise_floor, mask),
                    _estimate_passes_within_time(limit, seconds, finished),
                )
            if progress:
                progress(min(done, expected * names), expected * names, **keywords)
            if finished == expected:
                break
    except KeyboardInterrupt:
        if not finished:
            raise

    first, requested = growing.accumulated[reference], sum(passes[:expected])
    return Traced(growing.pictures(), first, first.spp, requested, time.perf_counter() - start)


def _find_progress_arguments(
    progress: Callable[..., object] | None, growing: Progressive
) -> dict[str, Callable[[], Any]]:
    """Return the keyword argument `pictures` for `progress`, if it has a parameter of this name.

    The argument is a function, so that the pictures are computed only when it is called.
    """
    with suppress(TypeError, ValueError):  # some callables, such as built-ins, have no signature
        if progress and "pictures" in inspect.signature(progress).parameters:
            return {"pictures": growing.pictures}
    return {}


def _estimate_passes_to_noise_floor(
    passes: Sequence[int],
    done: int,
    halves: Halves,
    noise_floor: float | None,
    mask: BoolArray | None,
) -> int:
    """Estimate how many passes reach the noise floor [dB]; `done` passes are finished.

    `passes` are the samples per pixel of each pass, `halves` two pictures from half of the finished
    passes each, and `mask` the pixels that count.
    """
    if noise_floor is None or done == 1:
        return len(passes)
    floor = psnr(halves.picture, halves.other_seed, mask)
    if not floor < noise_floor:  # true also for NaN, if no pixel shows the material
        return done
    samples = estimate_samples(noise_floor, floor, sum(halves.spp))
    needed = np.searchsorted(np.cumsum(passes), samples) + 1
    return int(np.clip(needed, done + 1, len(passes)))


def _estimate_passes_within_time(limit: float | None, seconds: float, done: int) -> int:
    """Estimate how many passes begin before the `limit` [s]; `done` passes took `seconds`."""
    if limit is None:
        return sys.maxsize
    return done if seconds >= limit else max(done + 1, int(limit / seconds * done))


def divide_into_passes(spp: int, largest: int) -> Iterator[int]:
    """Divide `spp` samples per pixel into passes of at most `largest`; yield each pass's number.

    Each number is a product of two nearly equal integers, so that stratified samplers work well.

    >>> list(divide_into_passes(64, 32))
    [30, 30, 4]
    """
    while spp:
        count = min(spp, largest)
        count -= count % isqrt(count)
        yield count
        spp -= count
