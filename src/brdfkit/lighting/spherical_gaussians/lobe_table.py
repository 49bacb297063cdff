"""`LobeTable`: BRDF × cosine as spherical Gaussians at a grid of views, and between them.

    f(i, o) cosθ_i ≈ d(o) cosθ_i / π + Σ_k w_k(o) g(i; μ_k(o), κ_k(o))

At a view o between the stored ones, d, w, κ and μ are interpolated: lobe k of one view corresponds
to lobe k of its neighbours. A white environment of radiance 1 thus gives d + Σ w.
"""

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from brdfkit.core.geometry.directions import normalize, rotate_z, to_angles
from brdfkit.core.geometry.multilinear import bracket, corners, flat_index, periodic_bracket
from brdfkit.lighting.spherical_gaussians.von_mises_fisher import density

Floats = NDArray[np.float64]


@dataclass(frozen=True)
class LobeTable:
    """The lobes of a material at each view; see the file.

    The views are a grid of `theta_o` × `phi_o`, the azimuth fastest: view i·len(phi_o) + j has
    theta_o[i] and phi_o[j], which is j·2π/len(phi_o). One azimuth stands for all of an isotropic
    material. The axes are stored as if every view had azimuth 0, in the plane y = 0 with x ≥ 0, and
    are turned about z by the azimuth of the view: the lobes of neighbours are most alike so.
    """

    theta_o: Floats = field(repr=False)  #: (nθ,) [rad], evenly from 0, below π/2
    phi_o: Floats = field(repr=False)  #: (nφ,) [rad], evenly from 0 around the circle
    diffuse: Floats = field(repr=False)  #: (views, channels) albedo of the diffuse part
    weights: Floats = field(repr=False)  #: (views, lobes, channels) integral of each lobe
    axes: Floats = field(
        repr=False
    )  #: (views, lobes, 3) unit vectors, z along the normal, see above
    kappa: Floats = field(repr=False)  #: (views, lobes) concentrations

    def at(self, wo):
        """(diffuse (n, channels), weights (n, lobes, channels), axes (n, lobes, 3), kappa
        (n, lobes)) at views `wo` (n, 3); beyond the last theta_o, those of the last."""
        theta, phi = to_angles(wo)
        brackets = [bracket(theta / self.theta_o[1], len(self.theta_o))]
        brackets += [periodic_bracket(phi / (2 * np.pi) * len(self.phi_o), len(self.phi_o))]
        shape = len(self.theta_o), len(self.phi_o)
        shares = [(flat_index(nodes, shape), share) for nodes, share in corners(brackets)]

        def mixed(values):
            each = (-1,) + (1,) * (values.ndim - 1)
            return sum(values[view] * np.reshape(share, each) for view, share in shares)

        axes = rotate_z(normalize(mixed(self.axes)), phi[:, None])
        return mixed(self.diffuse), mixed(self.weights), axes, mixed(self.kappa)

    def eval(self, wi, wo):
        """BRDF × cosθ_i (n, channels) [sr⁻¹] as the lobes have it, of direction pairs (n, 3)."""
        diffuse, weights, axes, kappa = self.at(wo)
        lobes = density(wi[:, None, :], axes, kappa)
        return diffuse * np.maximum(wi[:, 2:], 0) / np.pi + np.einsum("nk,nkc->nc", lobes, weights)
