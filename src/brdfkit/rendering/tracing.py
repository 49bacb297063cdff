"""Path-traces scenes pass by pass, all of them together."""

import time
from math import isqrt

import numpy as np

from brdfkit.errors import BrdfkitError

PASS = 32  # samples per pixel in one pass at most: how often progress shows
RAYS = 2**23  # camera rays in one pass at most: bounds the memory, about 1 GB


def trace(loaded, spp, seed, progress):
    """(pictures, spp reached, seconds) of name → scene; passes outside, pictures inside."""
    if spp < 1:
        raise BrdfkitError(f"{spp} spp make no picture; give a number above 0.")
    if not 0 <= seed < 2**31:
        raise BrdfkitError(f"The seed {seed} is out of bounds; give one from 0 to 2³¹ - 1.")
    start = time.perf_counter()
    pixels = max(int(np.prod(s.sensors()[0].film().crop_size())) for s in loaded.values())
    passes = list(passes_of(spp, max(1, min(PASS, RAYS // pixels))))
    # one stream of seeds a render; the same pass has the same seed in every picture
    seeds = np.random.SeedSequence(seed).generate_state(len(passes))
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
    """Sample counts of the passes; each is a side × (side or a bit more), which stratify well.

    >>> list(passes_of(64, 32))
    [30, 30, 4]
    """
    while spp:
        count = min(spp, largest)
        count -= count % isqrt(count)
        yield count
        spp -= count


def _rgb(image):
    """(height, width, 3) float64 of a film, whatever its channels (one: grey; alpha is left)."""
    values = np.array(image, float)
    return np.repeat(values[..., :1], 3, axis=-1) if values.shape[-1] < 3 else values[..., :3]
