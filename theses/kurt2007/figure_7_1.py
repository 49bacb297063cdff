"""Reproduces Figure 7.1, a polynomial BRDF as a surface over its two principal components.

The thesis says that the components need no interaction terms; this is tested, too.
"""

import numpy as np
from brdfkit.theses.kurt2007.curet import PLAIN, load_samples

from brdfkit.fitting.fit import fit
from brdfkit.materials.loading import load
from brdfkit.materials.measured.selection import select_samples
from brdfkit.model.evaluation import to_weight_matrix
from brdfkit.theses.claims import NOT_RUN, UNSTATED, Claim, to_verdict
from brdfkit.theses.drawing import make_figure
from brdfkit.theses.page import Picture, Section, Table

SECONDS = 4
DEGREE = 5
LIMIT = 0.12  # sr⁻¹: the top of the figure, below which are most samples
DEGREES = 2, 3, 4, 7
TURNED, TURN = 7, 3  # degree of the polynomial of turned products, and step of the angle [degrees]
TEXT = """Z₁ and Z₂ are the principal components of W₁ = l_x v_x + l_y v_y and W₂ = l_z v_z over
the measured directions. The thesis shows Mystique lacquer; where its file is not at hand, this is
Cayman lacquer. It is the green channel, below 80°, by bisquare. The dots are samples, the lines the
polynomial, f = β₀ + g(Z₁) + h(Z₂)."""


def check_claims(sources, report):
    """Check the claims on the polynomial and its terms of interaction, and return their section."""
    mystique = sources.find_file("cornell/mystique.brdf")
    here = mystique.is_file()
    name = "Mystique" if here else "Cayman"
    file = mystique if here else sources.find_file("cornell/cayman.brdf")
    picture = _draw_figure(load(file), name)
    report(1, 3)
    samples = list(load_samples(sources).values())
    shares = _compare_interactions(samples)
    claims = [
        Claim(
            "f as a surface over Z₁ and Z₂, of Mystique lacquer.",
            "Figure 7.1",
            "a drawing",
            "a drawing" if here else "Cayman in its place",
            UNSTATED if here else NOT_RUN,
            "Nothing but the look could be compared."
            + ("" if here else " Cornell's mystique.brdf is not at hand."),
        ),
        Claim(
            "Principal components are orthogonal, so that their interactions vanish.",
            "7, eq. 7.5",
            "1 at every degree",
            ", ".join(f"{s:.2f} (p = {p})" for p, s in shares.items()),
            to_verdict(all(s > 0.99 for s in shares.values())),
            "Least E of a full polynomial of Z₁ and Z₂ over that of the sum without interactions, "
            "median of 52 samples. That two components do not correlate over the directions says "
            "nothing on the coefficient of their product.",
        ),
        _claim_turn(samples),
    ]
    return Section(
        "Figure 7.1: the polynomial's surface", TEXT, claims, [_make_table(shares)], [picture]
    )


def _make_table(shares):
    columns = "E with interactions / without", *(f"p = {p}" for p in shares)
    return Table(columns, [("median of 52", *(f"{s:.3f}" for s in shares.values()))])


def _compare_interactions(found):
    """Return by degree how much smaller the thesis's error E is with terms of interaction.

    Each value is the median over samples of E with such terms over E without.
    """
    ratios = {p: [] for p in DEGREES}
    for data in found:
        z = _compute_components(data.wi, data.wo, _find_principal_angle(data.wi, data.wo))
        z = z / np.abs(z).max(axis=0)
        for p, list_ in ratios.items():
            powers = [(j, k) for j in range(p + 1) for k in range(p + 1 - j)]
            full = np.stack([z[:, 0] ** j * z[:, 1] ** k for j, k in powers], axis=1)
            alone = full[:, [j == 0 or k == 0 for j, k in powers]]
            list_.append(
                np.divide(
                    *(
                        data.compute_value_error(c @ data.solve_coefficients(c))
                        for c in (full, alone)
                    )
                )
            )
    return {p: float(np.median(r)) for p, r in ratios.items()}


def _claim_turn(samples):
    """Return the claim on the principal components, beside products turned by other angles."""
    turns = np.radians(np.arange(0, 90, TURN))  # a right angle exchanges the components
    errors = np.array([[_compute_turned_error(data, a) for a in turns] for data in samples])
    first = samples[0]  # the directions of all samples are the same
    principal = _find_principal_angle(first.wi, first.wo)
    own = np.array([_compute_turned_error(data, principal) for data in samples])
    best = np.degrees(turns[errors.argmin(axis=1)])
    turned = (np.degrees(principal) + 90) % 180 - 90
    return Claim(
        "Principal components are the variables by which the polynomial fits best.",
        "7",
        "they are taken",
        f"W₁ and W₂ turned by {turned:.1f}°; at the best of all angles, {np.median(best):.0f}° in "
        f"the median, E is {np.median(errors.min(axis=1) / own):.2f} times as large (median)",
        UNSTATED,
        f"Least E, p = {TURNED}, each {TURN}°. The thesis takes them and compares them with no "
        "others. They depend on the measured directions alone and on no value, and here they are "
        "nearly W₁ and W₂ themselves.",
    )


def _compute_turned_error(data, angle):
    """Return the least E of the polynomial of a sample's products, turned by an angle [rad]."""
    z = _compute_components(data.wi, data.wo, angle)
    z = z / np.abs(z).max(axis=0)
    powers = np.concatenate([z**k for k in range(1, TURNED + 1)], axis=1)
    columns = np.concatenate([np.ones((len(z), 1)), powers], axis=1)
    return data.compute_value_error(columns @ data.solve_coefficients(columns))


def _multiply_directions(wi, wo):
    return np.stack([(wi * wo)[:, :2].sum(axis=1), wi[:, 2] * wo[:, 2]], axis=1)


def _find_principal_angle(wi, wo):
    """Return the angle [rad] of the first principal axis of W₁ and W₂ over pairs of directions.

    W₁ = l_x v_x + l_y v_y and W₂ = l_z v_z are products of the directions' components.
    """
    _, axes = np.linalg.eigh(np.cov(_multiply_directions(wi, wo).T))
    return np.arctan2(axes[1, 1], axes[0, 1])


def _compute_components(wi, wo, angle):
    sine, cosine = np.sin(angle), np.cos(angle)
    return _multiply_directions(wi, wo) @ np.array([[cosine, -sine], [sine, cosine]])


def _draw_figure(data, name):
    from matplotlib.ticker import MaxNLocator

    found = fit(data, f"pca_polynomial:degree={DEGREE}", loss=PLAIN, robust="bisquare")
    shown, angle = select_samples(data, 80), found.values["angle_1_2"]
    z, f = _compute_components(shown.wi, shown.wo, angle), shown.values[:, 1]
    betas = to_weight_matrix(found.model)[:, 1]
    drawn = make_figure(6.0, 4.6)
    axes = drawn.add_subplot(projection="3d", computed_zorder=False)
    steps = [np.linspace(a, b, 33) for a, b in zip(z.min(axis=0), z.max(axis=0), strict=True)]
    grid = np.meshgrid(*steps, indexing="ij")
    surface = betas[0] + sum(
        betas[2 * k - 1] * grid[0] ** k + betas[2 * k] * grid[1] ** k for k in range(1, DEGREE + 1)
    )
    surface = np.where(_find_reachable(grid, angle) & (surface <= LIMIT), surface, np.nan)
    low = f <= LIMIT
    axes.scatter(*z[low].T, f[low], s=3, color="#d55e00", alpha=0.6, label="samples")
    axes.plot_wireframe(
        *grid, surface, rstride=1, cstride=1, linewidth=0.5, color="#0072b2", label="polynomial"
    )
    axes.set(xlabel="Z₁", ylabel="Z₂", zlabel="f [sr⁻¹], green", zlim=(0, LIMIT))
    for axis in (axes.xaxis, axes.yaxis, axes.zaxis):
        axis.set_major_locator(MaxNLocator(4))
    axes.view_init(22, -58)
    axes.legend(loc="upper left", frameon=False)
    caption = (
        f"{name} lacquer, p = {DEGREE}; the {(~low).sum()} of {len(f):,} samples above {LIMIT} "
        "sr⁻¹, those of the highlight, are not shown: for bisquare they are outliers."
    )
    return Picture("figure_7_1", drawn, caption)


def _find_reachable(grid, angle):
    """Return where on a grid of components Z₁, Z₂ some pair of directions below 80° has them.

    The condition is |W₁| ≤ sin θ_i sin θ_r.
    """
    sine, cosine = np.sin(angle), np.cos(angle)
    w1, w2 = cosine * grid[0] - sine * grid[1], sine * grid[0] + cosine * grid[1]
    return (w2 >= np.cos(np.radians(80)) ** 2) & (np.abs(w1) + w2 <= 1)
