"""Path-traces several scenes together, in passes that render every picture once."""

from __future__ import annotations

import inspect
import sys
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from math import isqrt
from typing import Any

import numpy as np
from numpy.typing import NDArray

from brdfkit.core.array_types import BoolArray, MitsubaObject
from brdfkit.core.errors import BrdfkitError
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
    if seed >= 2**31:
        raise BrdfkitError(f"The seed {seed} is out of bounds; give one from 0 to 2³¹ - 1.")
    start = time.perf_counter()
    pixels = max(int(np.prod(s.sensors()[0].film().crop_size())) for s in loaded.values())
    passes = list(
        divide_into_passes(spp, max(1, min(most or PASS, RAYS // pixels, (spp + 1) // 2)))
    )
    growing, reference = Progressive(loaded, seed), next(iter(loaded))
    expected, keywords = len(passes), _find_progress_arguments(progress, growing)
    try:
        for number, count in enumerate(passes):
            generated: dict[str, NDArray[np.float32]] = {}
            for name in loaded:
                generated[name] = growing.generate(name, count)
                if len(generated) == len(loaded):
                    growing.integrate(generated, count)
                    halves = growing.accumulated[reference].halves
                    expected = min(
                        _estimate_passes_to_noise_floor(
                            passes, number + 1, halves, noise_floor, mask
                        ),
                        _estimate_passes_within_time(
                            limit, time.perf_counter() - start, number + 1
                        ),
                    )
                if progress:
                    done = number * len(loaded) + len(generated)
                    progress(done, expected * len(loaded), **keywords)
            if number + 1 == expected:
                break
    except KeyboardInterrupt:
        if not growing.accumulated[reference].passes:
            raise

    pictures = growing.pictures()
    first, requested = growing.accumulated[reference], sum(passes[:expected])
    return Traced(pictures, first, first.spp, requested, time.perf_counter() - start)


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
