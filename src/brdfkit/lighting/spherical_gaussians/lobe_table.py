"""`fit_lobe_table` approximates a material's BRDF × cosine by spherical Gaussians at many views.

    f(i, o) cosθ_i ≈ d(o) cosθ_i / π + Σ_k w_k(o) g(i; μ_k(o), κ_k(o))

with the BRDF f, the light's direction i at the polar angle θ_i, the view o, the albedo d of the
diffuse part, and lobes g with axes μ_k, concentrations κ_k and integrals w_k. Between the views, d,
w, κ and μ are interpolated, since lobe k of a view corresponds to lobe k of its neighbours. The
albedo for a view is d + Σ w.
"""

from dataclasses import dataclass, field

import numpy as np

from brdfkit.core.arguments import to_whole_number
from brdfkit.core.array_types import FloatArray
from brdfkit.core.errors import no_such_error
from brdfkit.core.geometry.directions import normalize, rotate_z, to_angles
from brdfkit.core.geometry.multilinear import (
    find_bracket,
    find_periodic_bracket,
    list_corners,
    to_flat_index,
)
from brdfkit.lighting.spherical_gaussians.elliptic import fit_elliptic_lobes
from brdfkit.lighting.spherical_gaussians.gmm import fit_gmm_lobes
from brdfkit.lighting.spherical_gaussians.one_view import Brdf, sample_view
from brdfkit.lighting.spherical_gaussians.single_lobe import fit_kde_lobes, fit_warped_lobes
from brdfkit.lighting.spherical_gaussians.von_mises_fisher import density

METHODS = {
    "gmm": fit_gmm_lobes,
    "elliptic": fit_elliptic_lobes,
    "kde": fit_kde_lobes,
    "warped": fit_warped_lobes,
}
LARGEST_THETA_O = np.radians(88)  # largest angle of a view [rad]; few pixels of a ball exceed it


@dataclass(frozen=True)
class LobeTable:
    """The spherical Gaussian lobes of a material at a grid of views, which `fit_lobe_table` makes.

    View i·len(phi_o) + j has the polar angle theta_o[i] and the azimuth phi_o[j] = j·2π/len(phi_o).
    An isotropic material has one azimuth. Axes are stored as if every view had azimuth 0, and have
    to be turned about z by the azimuth of the view, so that neighbouring views have similar axes.
    """

    theta_o: FloatArray = field(repr=False)  #: (nθ,) polar angles of views [rad], from 0
    phi_o: FloatArray = field(repr=False)  #: (nφ,) azimuths of views [rad], from 0
    diffuse: FloatArray = field(repr=False)  #: (views, channels) albedo of the diffuse part
    weights: FloatArray = field(repr=False)  #: (views, lobes, channels) integral of each lobe
    axes: FloatArray = field(repr=False)  #: (views, lobes, 3) unit vectors; z: normal
    kappa: FloatArray = field(repr=False)  #: (views, lobes) concentration of each lobe

    def interpolate_lobes(
        self, wo: FloatArray
    ) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray]:
        """Interpolate the lobes between the stored views, at views `wo` (n, 3).

        Returns diffuse (n, channels), weights (n, lobes, channels), axes (n, lobes, 3) and kappa
        (n, lobes). Beyond the last theta_o they are those of the last.
        """
        theta, phi = to_angles(wo)
        brackets = [find_bracket(theta / self.theta_o[1], len(self.theta_o))]
        brackets += [find_periodic_bracket(phi / (2 * np.pi) * len(self.phi_o), len(self.phi_o))]
        shape = len(self.theta_o), len(self.phi_o)
        shares = [(to_flat_index(nodes, shape), share) for nodes, share in list_corners(brackets)]

        def interpolate_views(values: FloatArray) -> FloatArray:
            each = (-1,) + (1,) * (values.ndim - 1)
            return np.sum([values[view] * np.reshape(s, each) for view, s in shares], axis=0)

        axes = rotate_z(normalize(interpolate_views(self.axes)), phi[:, None])
        diffuse, weights = interpolate_views(self.diffuse), interpolate_views(self.weights)
        return diffuse, weights, axes, interpolate_views(self.kappa)

    def eval(self, wi: FloatArray, wo: FloatArray) -> FloatArray:
        """Evaluate BRDF × cosine (n, channels) [sr⁻¹] by the lobes, for direction pairs (n, 3)."""
        diffuse, weights, axes, kappa = self.interpolate_lobes(wo)
        lobes = density(wi[:, None, :], axes, kappa)
        return diffuse * np.maximum(wi[:, 2:], 0) / np.pi + np.einsum("nk,nkc->nc", lobes, weights)


def fit_lobe_table(
    brdf: Brdf, method: str = "gmm", lobes: int = 32, views: int = 24, azimuths: int = 1
) -> LobeTable:
    """Fit spherical Gaussians to a material at a grid of views.

    Parameters
    ----------
    brdf : callable
        ``brdf(wi, wo)`` gives (n, channels) in sr⁻¹, without a cosine, for pairs of unit vectors
        (n, 3) above the surface: the `eval` of any material.
    method : str, default "gmm"
        "gmm" fits a mixture at each view, and is the nearest to the material; "warped" fits one
        lobe per view; "kde" puts `lobes` sharper lobes in its place; "elliptic" spreads these over
        an ellipse, for brushed metal and grazing views.
    lobes : int, default 32
        Number of lobes per view, at least 1; "warped" has 1.
    views : int, default 24
        Number of polar angles of the view, evenly from 0 to 88°, at least 2.
    azimuths : int, default 1
        Number of azimuths of the view, evenly around the circle: 1 for an isotropic material, about
        16 otherwise.

    Returns
    -------
    LobeTable
        The lobes at all views. The same arguments always give the same table.

    Raises
    ------
    BrdfkitError
        If the method is unknown, a count is too small, or a value of the BRDF is not finite.

    Examples
    --------
    >>> fit_lobe_table(model.eval, lobes=16).weights.shape
    (24, 16, 3)
    """
    if method not in METHODS:
        raise no_such_error("method", method, METHODS)
    lobes = to_whole_number("lobes", lobes, least=1)
    theta_o = np.linspace(0, LARGEST_THETA_O, to_whole_number("views", views, least=2))
    phi_o = np.arange(to_whole_number("azimuths", azimuths, least=1)) * 2 * np.pi / azimuths
    grid = [[sample_view(brdf, theta, phi) for theta in theta_o] for phi in phi_o]
    by_azimuth = METHODS[method](grid, lobes)
    # `by_azimuth` has four arrays per view; stack them over all views, with the azimuth fastest
    return LobeTable(
        theta_o,
        phi_o,
        *(np.array([row[i][k] for i in range(views) for row in by_azimuth]) for k in range(4)),
    )
