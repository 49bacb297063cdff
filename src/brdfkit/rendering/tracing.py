"""Path-traces several scenes together: each pass renders every picture once."""

import inspect
import sys
import time
from contextlib import suppress
from dataclasses import dataclass
from math import isqrt

import numpy as np

from brdfkit.core.errors import BrdfkitError
from brdfkit.images.errors.noise import Accumulated, estimate_samples
from brdfkit.images.errors.psnr import psnr
from brdfkit.rendering.progressive import Progressive

# Samples per pixel in one pass, at most; progress is reported after each. A power of two, so that a
# block of one thread holds all samples of a pixel: see `brdfkit.reporting.pictures.pictures`
PASS = 16
RAYS = 2**22  # camera rays in one pass, at most; bounds the memory, and how long Ctrl-C waits


@dataclass(frozen=True)
class Traced:
    """What `trace` makes: the pictures by name; `first`, what the first one adds up to; the samples
    per pixel reached and asked for; and the seconds."""

    pictures: dict[str, np.ndarray]
    first: Accumulated
    spp: int
    requested: int
    seconds: float


def trace(loaded, spp, seed, progress, noise_floor=None, mask=None, limit=None, most=None):
    """The `Traced` pictures of `loaded`, scenes by name; the first is the reference.

    Each pass renders every picture once, of `most` samples per pixel at most, by default PASS, and
    there are at least two, for the noise. Where a `noise_floor` [dB] is given, over the
    `mask`, they end as soon as it is reached; `spp` is then the most; with a `limit` [s] after the
    pass in which it is over. Ctrl-C ends after the last pass that all pictures have; it is raised
    where there is none. `progress`: called with (done, total) after each picture of a pass; one
    with a parameter `pictures` gets the function to ask for the pictures so far, too.
    """
    if seed >= 2**31:
        raise BrdfkitError(f"The seed {seed} is out of bounds; give one from 0 to 2³¹ - 1.")
    start = time.perf_counter()
    pixels = max(int(np.prod(s.sensors()[0].film().crop_size())) for s in loaded.values())
    passes = list(passes_of(spp, max(1, min(most or PASS, RAYS // pixels, (spp + 1) // 2))))
    growing, reference = Progressive(loaded, seed), next(iter(loaded))
    expected, more = len(passes), _of_pictures(progress, growing)
    try:
        for number, count in enumerate(passes):
            generated = {}
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
                    progress(done, expected * len(loaded), **more)
            if number + 1 == expected:
                break
    except KeyboardInterrupt:
        if not growing.accumulated[reference].passes:
            raise

    pictures = growing.pictures()
    first, requested = growing.accumulated[reference], sum(passes[:expected])
    return Traced(pictures, first, first.spp, requested, time.perf_counter() - start)


def _of_pictures(progress, growing):
    """The keywords of a `progress`: the function of the pictures so far, where it has a parameter
    for it. Nothing is summed up for one that does not ask."""
    with suppress(TypeError, ValueError):  # of no function that tells its parameters
        if "pictures" in inspect.signature(progress).parameters:
            return {"pictures": growing.pictures}
    return {}


def _passes_needed(passes, done, halves, noise_floor, mask):
    """How many of the `passes` it takes to a noise floor of `noise_floor` [dB], `done` or more."""
    if noise_floor is None or done == 1:
        return len(passes)
    floor = psnr(halves.picture, halves.other_seed, mask)
    if not floor < noise_floor:  # or unknown, where nothing shows the material
        return done
    samples = estimate_samples(noise_floor, floor, sum(halves.spp))
    needed = np.searchsorted(np.cumsum(passes), samples) + 1
    return int(np.clip(needed, done + 1, len(passes)))


def _passes_within(limit, seconds, done):
    """About how many passes begin within a `limit` [s], of which those `done` took so long."""
    if limit is None:
        return sys.maxsize
    return done if seconds >= limit else max(done + 1, int(limit / seconds * done))


def passes_of(spp, largest):
    """Sample counts of the passes for `spp`, each at most `largest`.

    Each is a product of two integers that are nearly equal, which stratifies well.

    >>> list(passes_of(64, 32))
    [30, 30, 4]
    """
    while spp:
        count = min(spp, largest)
        count -= count % isqrt(count)
        yield count
        spp -= count
