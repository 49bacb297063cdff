"""`lobe_table`: the spherical Gaussians of any material, at a grid of views."""

from collections.abc import Callable

import numpy as np

from brdfkit.core.arguments import to_whole_number
from brdfkit.core.errors import no_such
from brdfkit.lighting.spherical_gaussians.elliptic import elliptic
from brdfkit.lighting.spherical_gaussians.gmm import gmm
from brdfkit.lighting.spherical_gaussians.lobe_table import Floats, LobeTable
from brdfkit.lighting.spherical_gaussians.one_view import one_view
from brdfkit.lighting.spherical_gaussians.single import kde, warped

METHODS = {"gmm": gmm, "elliptic": elliptic, "kde": kde, "warped": warped}
LAST = np.radians(88)  # of theta_o: beyond it, a ball has a thousandth of its pixels


def lobe_table(
    brdf: Callable[[Floats, Floats], Floats],
    method: str = "gmm",
    lobes: int = 32,
    views: int = 24,
    azimuths: int = 1,
) -> LobeTable:
    """The lobes of a material at a grid of views.

    Parameters
    ----------
    brdf : callable
        ``brdf(wi, wo)`` gives (n, channels) in sr⁻¹, without a cosine, of pairs of unit vectors
        (n, 3) above the surface: the `eval` of any material.
    method : str, default "gmm"
        "gmm": a mixture fitted at each view, the nearest to the material; "warped": one lobe per
        view; "kde": as many sharper lobes in place of that one; "elliptic": these spread over an
        ellipse, for brushed metal and grazing views.
    lobes : int, default 32
        Lobes per view, at least 1; "warped" has 1.
    views : int, default 24
        Polar angles of the view, evenly from 0 to 88°, at least 2.
    azimuths : int, default 1
        Azimuths of the view, evenly around the circle: 1 for an isotropic material, else about 16.

    Returns
    -------
    LobeTable
        The same for the same arguments.

    Raises
    ------
    BrdfkitError
        For an unknown method, counts that are too small, and values that are not finite.

    Examples
    --------
    >>> lobe_table(model.eval, lobes=16).weights.shape
    (24, 16, 3)
    """
    if method not in METHODS:
        raise no_such("method", method, METHODS)
    lobes = to_whole_number("lobes", lobes, least=1)
    theta_o = np.linspace(0, LAST, to_whole_number("views", views, least=2))
    phi_o = np.arange(to_whole_number("azimuths", azimuths, least=1)) * 2 * np.pi / azimuths
    grid = [[one_view(brdf, theta, phi) for theta in theta_o] for phi in phi_o]
    found = METHODS[method](grid, lobes)
    # [azimuth][theta] of four parts to four arrays (views, ...), the azimuth fastest
    parts = [np.array([azimuth[i][k] for i in range(views) for azimuth in found]) for k in range(4)]
    return LobeTable(theta_o, phi_o, *parts)
