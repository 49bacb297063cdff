"""The derivatives of rendered pictures by few numbers: a picture for each of them."""

from contextlib import contextmanager

import drjit as dr
import numpy as np

from brdfkit.core.jit.loops import first_error
from brdfkit.inverse.scenes.problem.views import opaque

DERIVATIVE_COST = 2.3  # of a picture of derivatives, in pictures
STEP = 0.05  # of differences, in coordinates, or of what has no bounds relative to it
BACKWARD = "PRBVolpathIntegrator", "BasicVolumetricPrimitiveRadianceFieldIntegrator"
UNATTACHED = "not attached to the AD graph"  # what Mitsuba says of a picture without derivatives


def derivatives(views, x, spp, seed):
    """The derivatives (n, pixels, channels) of the pixels of `Views` by the coordinates `x`, by
    `spp` samples of a `seed`."""
    found = np.zeros((len(x), *views.reached.shape), np.float32)
    for numbers in tangents(views):
        share(_derivative(views, x, numbers, spp, seed), found, numbers)
    return found


def tangents(views):
    """The numbers of which one picture has the derivatives: those of a colour, or one."""
    for end, unknown in zip(views.ends, views.unknowns, strict=True):
        rows = list(range(end - len(unknown.start), end))
        yield from [rows] if unknown.colour else [[row] for row in rows]


def share(picture, found, rows):
    """Put a picture (pixels, channels) into the `rows` of `found` (n, pixels, channels): whole, or
    to each number of a colour its own channel, for it changes no other."""
    for channel, row in enumerate(rows):
        own = [channel] if 1 < len(rows) == picture.shape[1] else slice(None)
        found[row][:, own] = picture[:, own]


def integrator_is_backward(views):
    """Whether the integrator has derivatives only backwards."""
    return type(views.integrator).__name__ in BACKWARD


@contextmanager
def differentiated(views, x):
    """The values at `x`, in the scene, with derivatives; yields the entries of the unknowns.

    They are without derivatives afterwards, whatever happens: Dr.Jit's loops go through the BSDFs
    of all scenes, and would fail in every other one for what is left here.
    """
    entries = views.entries(x)
    dr.enable_grad(entries)
    try:
        views.put_entries(entries)
        yield entries
    finally:
        views.put(x)


def _derivative(views, x, numbers, spp, seed):
    """That of the pixels where the `numbers` move together: by differences where Mitsuba knows
    none, as of the place of a lamp, or wrong ones."""
    known = not views.wrongly[numbers].any() and not integrator_is_backward(views)
    picture = _forward(views, x, numbers, spp, seed) if known else None
    if picture is None or not picture.any():
        return _differences(views, x, numbers, spp, seed)
    return picture


def _forward(views, x, numbers, spp, seed):
    """The derivative of the pixels where the `numbers` move together; None where the integrator
    finds nothing to differentiate."""
    views.renders += DERIVATIVE_COST * spp
    tangent = np.zeros(len(x))
    tangent[numbers] = views.slopes(x)[numbers]
    try:
        # of all unknowns, 0 of those that rest, so that all derivatives share one kernel
        with first_error(), differentiated(views, x) as entries:
            for entry, along in zip(entries, views.parts(tangent), strict=True):
                dr.set_grad(entry, opaque(type(entry), along))
            # on to what plugins make of their parameters: no loop reaches beyond itself
            dr.enqueue(dr.ADMode.Forward, entries)
            dr.traverse(dr.ADMode.Forward, flags=dr.ADFlag.ClearEdges)
            return views.joined(
                [
                    views.integrator.render_forward(
                        views.scene,
                        views.parameters,
                        sensor=sensor,
                        seed=int(seed) + i,
                        spp=int(spp),
                    )
                    for i, sensor in enumerate(views.scene.sensors())
                ]
            )
    except Exception as error:
        if UNATTACHED not in str(error):
            raise
        return None


def _differences(views, x, numbers, spp, seed):
    """The same by differences of equal samples."""
    ends = np.array([x, x], float)
    step = STEP * np.maximum(np.abs(x), STEP)
    step[views.most - views.least == 1] = STEP
    ends[:, numbers] += np.outer([-1, 1], step[numbers])
    ends = np.clip(ends, views.least, views.most)
    low, high = (views.residuals(end, spp, seed) for end in ends)
    width = (ends[1] - ends[0])[numbers]
    return (high - low) / (width if len(width) == high.shape[1] else width[0])
