"""Path-traces several scenes together: each pass renders every picture once."""

import time
from dataclasses import dataclass
from math import isqrt

import numpy as np

from brdfkit.errors import BrdfkitError
from brdfkit.picture_errors.noise import Halves, samples_for
from brdfkit.picture_errors.psnr import psnr

# Samples per pixel in one pass, at most; progress is reported after each. A power of two, so that a
# block of one thread holds all samples of a pixel: see `brdfkit.reporting.pictures`
PASS = 16
RAYS = 2**23  # camera rays in one pass, at most; bounds the memory to about 1 GB


@dataclass(frozen=True)
class Traced:
    """What `trace` makes: the pictures by name; `other_seed`, the first one as with another seed
    (None for one pass); the samples per pixel reached and asked for; and the seconds."""

    pictures: dict[str, np.ndarray]
    other_seed: np.ndarray | None
    spp: int
    asked: int
    seconds: float


def trace(loaded, spp, seed, progress, until=None, mask=None):
    """The `Traced` pictures of `loaded`, scenes by name; the first is the reference.

    Each pass renders every picture once, and there are at least two, for the noise. Where a noise
    floor `until` [dB] is given, over the `mask`, they end as soon as it is reached; `spp` is then
    the most. Ctrl-C ends after the last pass that all pictures have; it is raised where there is
    none. `progress`: called with (done, total) after each picture of a pass.
    """
    if seed >= 2**31:
        raise BrdfkitError(f"The seed {seed} is out of bounds; give one from 0 to 2³¹ - 1.")
    start = time.perf_counter()

    # the passes, and their seeds: a pass has the same seed in every picture
    pixels = max(int(np.prod(s.sensors()[0].film().crop_size())) for s in loaded.values())
    passes = list(passes_of(spp, max(1, min(PASS, RAYS // pixels, (spp + 1) // 2))))
    seeds = np.random.SeedSequence(seed).generate_state(len(passes))

    # sums over the samples; a pass counts once all pictures have it
    reference, *_ = loaded
    sums, halves, reached = dict.fromkeys(loaded, 0.0), Halves(), 0
    expected = len(passes)
    try:
        for number, (count, pass_seed) in enumerate(zip(passes, seeds, strict=True)):
            finished = {}
            for name, scene in loaded.items():
                # not mi.render: it turns Ctrl-C into a RuntimeError
                image = scene.integrator().render(scene, seed=int(pass_seed), spp=count)
                finished[name] = sums[name] + count * rgb(image)
                if len(finished) == len(loaded):
                    halves = halves.plus((finished[reference] - sums[reference]) / count, count)
                    sums, reached = finished, reached + count
                    expected = _passes_needed(passes, number + 1, halves, until, mask)
                if progress:
                    progress(number * len(loaded) + len(finished), expected * len(loaded))
            if number + 1 == expected:
                break
    except KeyboardInterrupt:
        if not reached:
            raise

    pictures = {name: (s / reached).astype(np.float32) for name, s in sums.items()}
    other = halves.other_seed
    other = None if other is None else other.astype(np.float32)
    asked = sum(passes[:expected])
    return Traced(pictures, other, reached, asked, time.perf_counter() - start)


def _passes_needed(passes, done, halves, until, mask):
    """How many of the `passes` it takes to a noise floor of `until` [dB], `done` or more."""
    if until is None or done == 1:
        return len(passes)
    floor = psnr(halves.picture, halves.other_seed, mask)
    if not floor < until:  # or unknown, where nothing shows the material
        return done
    samples = samples_for(until, floor, sum(halves.spp))
    needed = np.searchsorted(np.cumsum(passes), samples) + 1
    return int(np.clip(needed, done + 1, len(passes)))


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


def rgb(image):
    """(height, width, 3) float64 of a film; one channel counts as grey, alpha is dropped."""
    values = np.array(image, float)
    return np.repeat(values[..., :1], 3, axis=-1) if values.shape[-1] < 3 else values[..., :3]
