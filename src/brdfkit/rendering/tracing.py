"""Path-traces several scenes together: each pass renders every picture once."""

import time
from math import isqrt

import numpy as np

from brdfkit.errors import BrdfkitError

PASS = 32  # samples per pixel in one pass, at most; progress is reported after each
RAYS = 2**23  # camera rays in one pass, at most; bounds the memory to about 1 GB


def trace(loaded, spp, seed, progress):
    """(pictures by name, samples per pixel reached, seconds) of `loaded`, scenes by name.

    Each pass renders every picture once. Ctrl-C ends after the last pass that all pictures have; it
    is raised where there is none. `progress`: called with (done, total) after each picture of a
    pass.
    """
    if seed >= 2**31:
        raise BrdfkitError(f"The seed {seed} is out of bounds; give one from 0 to 2³¹ - 1.")
    start = time.perf_counter()

    # the passes, and their seeds: a pass has the same seed in every picture
    pixels = max(int(np.prod(s.sensors()[0].film().crop_size())) for s in loaded.values())
    passes = list(passes_of(spp, max(1, min(PASS, RAYS // pixels))))
    seeds = np.random.SeedSequence(seed).generate_state(len(passes))

    # sums over the samples; a pass counts once all pictures have it
    total = len(passes) * len(loaded)
    sums, reached = dict.fromkeys(loaded, 0.0), 0
    try:
        for number, (count, pass_seed) in enumerate(zip(passes, seeds, strict=True)):
            finished = {}
            for done, (name, scene) in enumerate(loaded.items(), number * len(loaded) + 1):
                # not mi.render: it turns Ctrl-C into a RuntimeError
                image = scene.integrator().render(scene, seed=int(pass_seed), spp=count)
                picture = _rgb(image)
                finished[name] = sums[name] + count * picture
                if len(finished) == len(loaded):
                    sums, reached = finished, reached + count
                if progress:
                    progress(done, total)
    except KeyboardInterrupt:
        if not reached:
            raise

    pictures = {name: (s / reached).astype(np.float32) for name, s in sums.items()}
    return pictures, reached, time.perf_counter() - start


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


def _rgb(image):
    """(height, width, 3) float64 of a film; one channel counts as grey, alpha is dropped."""
    values = np.array(image, float)
    return np.repeat(values[..., :1], 3, axis=-1) if values.shape[-1] < 3 else values[..., :3]
