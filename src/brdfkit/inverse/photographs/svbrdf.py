"""The public function `svbrdf`, which fits maps of a sample or an object to photographs of it."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import numpy as np

from brdfkit.core.errors import BrdfkitError
from brdfkit.core.jit.threads import in_turn
from brdfkit.core.progress_bar import Progress
from brdfkit.inverse.photographs.arguments import (
    check_variant,
    choose_hidden_photographs,
    to_capture,
    to_smoothness,
    to_texel_parameters,
)
from brdfkit.inverse.photographs.capture.capture import Capture
from brdfkit.inverse.photographs.capture.object_capture import ObjectCapture
from brdfkit.inverse.photographs.objects.checks import prepare_object
from brdfkit.inverse.photographs.objects.object_maps import ObjectMaps
from brdfkit.inverse.photographs.objects.svbrdf_of_object import fit_maps_of_object
from brdfkit.inverse.photographs.result.result import Svbrdf
from brdfkit.inverse.photographs.svbrdf_of_sample import fit_maps_of_sample


@in_turn
def svbrdf(
    capture: str | Path | Capture | ObjectCapture,
    model: str = "ggx",
    *,
    resolution: int | None = None,
    anisotropic: bool = False,
    fixed: Mapping[str, float] | None = None,
    smoothness: float | None = None,
    linearise: str | float | None = None,
    hold_out: int | None = None,
    checkpoint: str | Path | None = None,
    progress: Progress | None = None,
) -> Svbrdf | ObjectMaps:
    """Fit maps of a model's parameters and of the normal to photographs of a sample or an object.

    A flat sample, with lamps and cameras at known places, has maps of all parameters. Gauss-Newton
    steps fit maps of a few large texels first, then ever finer ones. Neighbouring texels are drawn
    to each other, so strongly that photographs held out are predicted best. Then Mitsuba renders
    the photographs of the maps, and the maps are corrected by the differences until only noise is
    left.

    An object, which a camera that stands still photographs under several lights, has maps of its
    normals and of the weights of the model's lobes; the model's other parameters are the same
    everywhere. Each pixel is fitted by itself, from photometric stereo, and photographs in which it
    is shadowed or clipped do not count.

    The fit assumes direct light alone. Ctrl-C raises `Interrupted`, whose ``best`` has the maps so
    far, without standard errors. Equal photographs give equal maps up to rounding, about 1e-8,
    because Mitsuba adds light up in any order.

    Parameters
    ----------
    capture : path, Capture or ObjectCapture
        A folder with photographs and their lights, of one of the kinds that
        docs/how_to/photographs.md lists; or the content of such a folder.
    model : str, default "ggx"
        Label of the model, with a shape parameter ``alpha_u`` or others.
    resolution : int, optional
        Texels along the longer side of the maps of a flat sample, at least 4. By default a texel is
        a square as large as a pixel in the middle, and there are at most 512.
    anisotropic : bool, default False
        Whether to fit maps of ``alpha_v`` and its like, and of ``anisotropy_angle``, the direction
        of ``alpha_u`` [radians, counterclockwise from the sample's x]; of flat samples only.
    fixed : dict of str to float, optional
        Shape parameters with a given value everywhere, as ``{"f0": 0.04}``. By default ``f0`` has
        the model's default: few lights do not tell it from the specular reflectance.
    smoothness : float, optional
        The typical difference of neighbouring texels of a flat sample, at least 0.003: less is
        smoother. By default photographs that are held out choose it; with fewer than 8 lights it
        is 0.1.
    linearise : str or float, optional
        How the numbers of photographs are coded: "linear" if they are in proportion to light,
        "sRGB", "gamma" (2.2), or the exponent of a gamma. Without it 16 bits are linear, and
        photographs of 8 bits are refused.
    hold_out : int, optional
        Hold every N-th photograph out of the fit, at least 2, and compare it with its prediction.
    checkpoint : path, optional
        A folder in which an interrupted search for maps of an object keeps its state, in the file
        ``unfinished.npz``. A later call with the same photographs goes on from there.
    progress : callable, optional
        Called with (done, total); see `brdfkit.progress`.

    Returns
    -------
    Svbrdf or ObjectMaps
        The maps with their uncertainty; prints as a table, and `write` makes files of it.

    Raises
    ------
    BrdfkitError
        For a folder, a file or photographs that are wrong, a model whose weights may be negative,
        unknown parameters, and a variant of Mitsuba without RGB.

    Examples
    --------
    >>> maps = svbrdf("photographs/paper")    # doctest: +SKIP
    >>> maps = svbrdf("pmsData/ballPNG", hold_out=4)    # doctest: +SKIP
    """
    check_variant()
    smoothness = to_smoothness(smoothness)
    parameters = to_texel_parameters(model, anisotropic, fixed)
    name, photographs = to_capture(capture, linearise)
    hidden_indices = choose_hidden_photographs(len(photographs.names), hold_out)
    chosen = np.setdiff1d(np.arange(len(photographs.names)), hidden_indices)
    if isinstance(photographs, ObjectCapture):
        _check_arguments_of_object(name, resolution, anisotropic, smoothness)
        photographs = prepare_object(photographs)
        hidden = photographs.select_lights(hidden_indices) if len(hidden_indices) else None
        fitted = photographs.select_lights(chosen) if len(hidden_indices) else photographs
        kept = None if checkpoint is None else Path(checkpoint)
        return fit_maps_of_object(fitted, hidden, model, parameters, kept, progress)
    withheld = photographs.select_lights(hidden_indices) if len(hidden_indices) else None
    used = photographs.select_lights(chosen) if len(hidden_indices) else photographs
    return fit_maps_of_sample(
        name, used, withheld, model, parameters, resolution, smoothness, progress
    )


def _check_arguments_of_object(
    name: str, resolution: int | None, anisotropic: bool, smoothness: float | None
) -> None:
    """Raise `BrdfkitError` for arguments that only maps of flat samples have."""
    given = {
        "resolution": resolution is not None,
        "anisotropic": anisotropic,
        "smoothness": smoothness is not None,
    }
    for argument, is_given in given.items():
        if is_given:
            raise BrdfkitError(
                f"{argument}: {name} is an object, whose maps have the photographs' pixels; only "
                "maps of flat samples take this argument, so leave it out."
            )
