"""`Progressive`: pictures that improve pass by pass [Lesar 2018, chapter 6].

The names of the three steps are those of the thesis. *Generate* renders a pass, *integrate* adds it
to the sums, whose mean is the picture, and *reset* discards all passes after a change of the scene.
`tracing.py` repeats the first two until the pictures are good enough; an interactive program can do
the same.
"""

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from brdfkit.core.array_types import MitsubaObject
from brdfkit.core.errors import BrdfkitError
from brdfkit.core.jit.loops import raise_first_cause
from brdfkit.images.errors.noise import Accumulated


class Progressive:
    """The accumulated passes of one or several scenes, rendered with the same samples.

    Attributes
    ----------
    scenes : dict of str to mitsuba.Scene
        The scenes, each with a camera and an integrator. Call `reset` after changing one by
        `mitsuba.traverse`.
    seed : int
        Seed of the samples, at least 0; equal seeds give equal passes.
    accumulated : dict of str to Accumulated
        The sums of the integrated passes, by the scene's name.

    Examples
    --------
    >>> growing = Progressive({"head": scene})    # doctest: +SKIP
    >>> for _ in range(30):
    ...     growing.integrate({"head": growing.generate("head", spp=1)}, spp=1)
    >>> show(growing.accumulated["head"].picture)
    """

    def __init__(self, scenes: Mapping[str, Any], seed: int = 0) -> None:
        if seed >= 2**31:
            raise BrdfkitError(f"The seed {seed} is out of bounds; give one from 0 to 2³¹ - 1.")
        self.scenes, self.seed = dict(scenes), seed
        self.reset()

    def reset(self) -> None:
        """Discard all passes, so that the next one is the first."""
        self.accumulated = dict.fromkeys(self.scenes, Accumulated())

    def generate(self, name: str, spp: int) -> NDArray[np.float32]:
        """Render the next pass of a scene, (height, width, 3), with `spp` samples per pixel.

        The pass is not in the picture until `integrate` adds it.
        """
        return render_pass(self.scenes[name], self.seed, self.accumulated[name].passes, spp)

    def pictures(self) -> dict[str, NDArray[np.float32]]:
        """Return the pictures (height, width, 3) by scene name; none before the first pass."""
        return {name: a.picture for name, a in self.accumulated.items() if a.passes}

    def integrate(self, generated: Mapping[str, NDArray[Any]], spp: int) -> None:
        """Add a pass of all scenes, with its pictures by scene name, to the accumulated passes."""
        self.accumulated = {
            name: before.add_pass(generated[name], spp) for name, before in self.accumulated.items()
        }


def render_pass(scene: MitsubaObject, seed: int, number: int, spp: int) -> NDArray[np.float32]:
    """Render pass `number`, from 0, of a scene, as (height, width, 3), with a `seed` for all."""
    import mitsuba as mi

    own = mi.UInt32(derive_seed(seed, number))
    # So that Ctrl-C arrives as KeyboardInterrupt, not in a RuntimeError of mi.render
    with raise_first_cause():
        return to_rgb(scene.integrator().render(scene, seed=own, spp=spp))


def derive_seed(seed: int, number: int) -> int:
    """Return the seed of pass `number`, from 0, of a rendering with a `seed`.

    Passes of neighbouring seeds have nothing in common.
    """
    return int(np.random.SeedSequence(seed).generate_state(number + 1)[number])


def to_rgb(image: Any) -> NDArray[np.float32]:
    """Convert an image of Mitsuba to an array (height, width, 3).

    A single channel becomes grey, and alpha is dropped.
    """
    values = np.array(image)
    return np.repeat(values[..., :1], 3, axis=-1) if values.shape[-1] < 3 else values[..., :3]
