"""Iterations of a scene: what is left of them is the rendering, not how it is prepared."""

import gc
from contextlib import contextmanager
from functools import partial

import drjit as dr

from brdfkit.core.jit.first_error import first_error


def iteration(spp=1):
    """A function (scene, seed) → the picture of `mi.render`, with so many samples per pixel.

    Recorded at its first call, and replayed: Mitsuba prepares each render for as long as a small
    picture takes. Dr.Jit records nothing while BSDFs of other scenes are alive, as in a notebook;
    then each is prepared.
    """
    import mitsuba as mi

    def render(scene, seed):
        return mi.render(scene, spp=spp, seed=seed)

    recorded = dr.freeze(render)

    def call(state, scene, seed):
        if state["recorded"]:
            try:
                # Ctrl-C is no reason to render once more
                with first_error(), without_collection():
                    return recorded(scene, mi.UInt32(seed))
            except RuntimeError:
                state["recorded"] = False
        return render(scene, seed)

    return partial(call, {"recorded": True})


@contextmanager
def without_collection():
    """Collects no garbage within the block: Dr.Jit ends the process where a scene is freed while
    it records."""
    was_enabled = gc.isenabled()
    gc.disable()
    try:
        yield
    finally:
        if was_enabled:
            gc.enable()
