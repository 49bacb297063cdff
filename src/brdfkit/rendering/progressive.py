"""`Progressive`: pictures that become better pass by pass [Lesar 2018, chapter 6].

A pass is *generated*, *integrated* into the sums of all passes, of which the picture is the mean,
and *reset* forgets them, as after a change of the scene. `tracing.py` does so until pictures are
good enough; a program with a window may, too.
"""

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from brdfkit.core.jit.loops import raise_first_cause
from brdfkit.images.errors.noise import Accumulated


class Progressive:
    """The passes of one or several scenes with the same samples, and what they add up to.

    Attributes
    ----------
    scenes : dict of str to mitsuba.Scene
        Each with a camera and an integrator. They may change, by `mitsuba.traverse`: `reset` then.
    seed : int
        Of the samples, at least 0; equal seeds give equal passes.
    accumulated : dict of str to Accumulated
        What was integrated, by the scene's name.

    Examples
    --------
    >>> growing = Progressive({"head": scene})    # doctest: +SKIP
    >>> for _ in range(30):
    ...     growing.integrate({"head": growing.generate("head", spp=1)}, spp=1)
    >>> show(growing.accumulated["head"].picture)
    """

    def __init__(self, scenes: Mapping[str, Any], seed: int = 0) -> None:
        self.scenes, self.seed = dict(scenes), seed
        self.reset()

    def reset(self) -> None:
        """Forget all passes: the next one is the first."""
        self.accumulated = dict.fromkeys(self.scenes, Accumulated())

    def generate(self, name: str, spp: int) -> NDArray[np.float32]:
        """The picture (height, width, 3) of a scene's next pass alone, of `spp` samples per pixel.

        It counts for nothing before it is integrated.
        """
        import mitsuba as mi

        number = self.accumulated[name].passes
        seed = np.random.SeedSequence(self.seed).generate_state(number + 1)[number]
        scene = self.scenes[name]
        # not mi.render: it turns Ctrl-C into a RuntimeError. drjit.freeze makes it no faster
        with raise_first_cause():
            return rgb(scene.integrator().render(scene, seed=mi.UInt32(int(seed)), spp=spp))

    def pictures(self) -> dict[str, NDArray[np.float32]]:
        """The pictures (height, width, 3) by the scene's name; none before the first pass."""
        return {name: a.picture for name, a in self.accumulated.items() if a.passes}

    def integrate(self, generated: Mapping[str, NDArray], spp: int) -> None:
        """Add the pictures of a pass, those of all scenes at once."""
        self.accumulated = {
            name: before.plus(generated[name], spp) for name, before in self.accumulated.items()
        }


def rgb(image: Any) -> NDArray:
    """(height, width, 3) of a film; one channel counts as grey, alpha is dropped."""
    values = np.array(image)
    return np.repeat(values[..., :1], 3, axis=-1) if values.shape[-1] < 3 else values[..., :3]
