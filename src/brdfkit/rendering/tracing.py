"""Path-traces several scenes together: each pass renders every picture once."""

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

# Samples per pixel in one pass, at most; progress is reported after each. A power of two, so that a
# block of one thread holds all samples of a pixel: see `brdfkit.reporting.pictures.pictures`
PASS = 16
RAYS = 2**22  # camera rays in one pass, at most; bounds the memory, and how long Ctrl-C waits


@dataclass(frozen=True)
class Traced:
    """The result of `trace`: the pictures by name, and how they were made.

    `first` has the accumulated passes of the first picture, the reference. `spp` and `requested`
    are the samples per pixel that were reached and requested. `seconds` is the wall-clock time.
    """

    pictures: dict[str, np.ndarray]
    first: Accumulated
    spp: int
    requested: int
    seconds: float


def trace(
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

    Each pass renders every picture once, with at most `most` samples per pixel, by default PASS.
    From two samples on there are at least two passes, which tell the noise. With a `noise_floor`
    [dB], measured over the `mask`, the passes end as soon as it is reached; with a `limit` [s],
    they end after the pass in which the time is over. `spp` is then the largest number of samples.

    Ctrl-C keeps the passes that all pictures have, and is raised if there is none. `progress` is
    called with (done, total) after each picture of a pass. If it has a parameter `pictures`, it
    also gets a function that returns the pictures so far.
    """
    if seed >= 2**31:
        raise BrdfkitError(f"The seed {seed} is out of bounds; give one from 0 to 2³¹ - 1.")
    start = time.perf_counter()
    pixels = max(int(np.prod(s.sensors()[0].film().crop_size())) for s in loaded.values())
    passes = list(
        divide_into_passes(spp, max(1, min(most or PASS, RAYS // pixels, (spp + 1) // 2)))
    )
    growing, reference = Progressive(loaded, seed), next(iter(loaded))
    expected, keywords = len(passes), _progress_keywords(progress, growing)
    try:
        for number, count in enumerate(passes):
            generated: dict[str, NDArray[np.float32]] = {}
            for name in loaded:
                generated[name] = growing.generate(name, count)
                if len(generated) == len(loaded):
                    growing.integrate(generated, count)
                    halves = growing.accumulated[reference].halves
                    expected = min(
                        _passes_needed(passes, number + 1, halves, noise_floor, mask),
                        _passes_within(limit, time.perf_counter() - start, number + 1),
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


def _progress_keywords(
    progress: Callable[..., object] | None, growing: Progressive
) -> dict[str, Callable[[], Any]]:
    """Return the keyword arguments of `progress`: `pictures`, if it has such a parameter.

    The argument is a function, so that the pictures are computed only when it is called.
    """
    with suppress(TypeError, ValueError):  # raised for objects without a signature
        if progress and "pictures" in inspect.signature(progress).parameters:
            return {"pictures": growing.pictures}
    return {}


def _passes_needed(
    passes: Sequence[int],
    done: int,
    halves: Halves,
    noise_floor: float | None,
    mask: BoolArray | None,
) -> int:
    """Estimate how many of the `passes` reach the noise floor [dB], at least the `done` ones.

    `passes` are their samples per pixel. `halves` are two pictures from half of the passes each.
    """
    if noise_floor is None or done == 1:
        return len(passes)
    floor = psnr(halves.picture, halves.other_seed, mask)
    if not floor < noise_floor:  # the floor is nan where no pixel shows the material
        return done
    samples = estimate_samples(noise_floor, floor, sum(halves.spp))
    needed = np.searchsorted(np.cumsum(passes), samples) + 1
    return int(np.clip(needed, done + 1, len(passes)))


def _passes_within(limit: float | None, seconds: float, done: int) -> int:
    """Estimate how many passes begin within a time `limit` [s]; the `done` ones took `seconds`."""
    if limit is None:
        return sys.maxsize
    return done if seconds >= limit else max(done + 1, int(limit / seconds * done))


def divide_into_passes(spp: int, largest: int) -> Iterator[int]:
    """Divide `spp` samples per pixel into passes of at most `largest`; yield the count of each.

    Each count is a product of two nearly equal integers, which stratifies well.

    >>> list(divide_into_passes(64, 32))
    [30, 30, 4]
    """
    while spp:
        count = min(spp, largest)
        count -= count % isqrt(count)
        yield count
        spp -= count
