"""Draws `docs/entrance.jpg`, the picture of the README: a measured material, its fit, their errors.

python docs/tools/make_entrance.py           # some minutes

Two balls are path-traced in the same light; the third picture shows their colour difference. The
curves are the measured and the fitted values in the plane of incidence.
"""

from pathlib import Path

import numpy as np
from matplotlib.figure import Figure

import brdfkit as bk
from brdfkit.core.colours import to_srgb
from brdfkit.core.geometry.directions import from_angles
from brdfkit.images.errors.colour_difference import ciede2000

MATERIAL, MODEL, LOSS = "car_paint", "ggx+ggx", "cbrt"
PICTURE = Path(__file__).parents[1] / "entrance.jpg"
SIZE, SPP, SEED = 320, 400, 1
LARGEST_DIFFERENCE = 5.0  # colour difference ΔE₀₀ at the bright end of the colour map
# Colours of the curves by angle of incidence [degrees]
INCIDENCES = {15: "#0072b2", 45: "#d55e00", 70: "#009e73"}


def draw_entrance():
    """Return the picture as a matplotlib `Figure`."""
    paint = bk.load(MATERIAL)
    fit = bk.fit(paint, MODEL, loss=LOSS)
    rendering = bk.render([paint, fit], spp=SPP, size=SIZE, seed=SEED)
    measured, fitted = rendering.pictures.values()
    difference = ciede2000(measured, fitted)
    noise = ciede2000(measured, rendering.other_seed)
    figure = Figure(figsize=(13, 3.5), dpi=110, facecolor="white", layout="constrained")
    axes = figure.subplots(1, 4, width_ratios=[1, 1, 1.12, 1.3])
    show_picture(axes[0], to_srgb(measured), f"measured: {paint.name}")
    show_picture(axes[1], to_srgb(fitted), f"fitted: {MODEL}")
    image = show_picture(axes[2], difference, "difference ΔE₀₀", vmax=LARGEST_DIFFERENCE)
    figure.colorbar(image, ax=axes[2], fraction=0.046, pad=0.03)
    typical = [np.median(values[rendering.mask]) for values in (difference, noise)]
    axes[2].set_xlabel("median {:.1f}, of which the noise has {:.1f}".format(*typical))
    plot_lobes(axes[3], paint, fit)
    return figure


def show_picture(axes, picture, title, vmax=None):
    axes.set_title(title)
    axes.set(xticks=[], yticks=[])
    return axes.imshow(picture, cmap="magma", vmin=0 if vmax else None, vmax=vmax)


def plot_lobes(axes, paint, fit):
    """Plot measured values as points and fitted ones as lines, over the outgoing angle θ_o.

    θ_o is negative on the side of the light.
    """
    angle = np.linspace(-80, 80, 161)
    wo = from_angles(np.radians(np.abs(angle)), np.where(angle < 0, 0.0, np.pi))
    for theta_i, colour in INCIDENCES.items():
        wi = np.broadcast_to(from_angles(np.radians(theta_i), 0.0), wo.shape)
        points, line = (material.eval(wi, wo).mean(axis=1) for material in (paint, fit))
        axes.semilogy(angle[::4], points[::4], "o", ms=3.5, mfc="none", color=colour)
        axes.semilogy(angle, line, color=colour, lw=1.2, label=f"θᵢ = {theta_i}°")
    errors = fit.standard_errors
    words = [
        f"α of lobe {number}: {fit.values[name]:.4f} ± {errors[name]:.5f}"
        for number, name in enumerate(find_lobe_widths(fit), 1)
    ]
    axes.text(0.02, 0.97, "\n".join(words), transform=axes.transAxes, va="top", size=8)
    axes.set_title("BRDF [sr⁻¹]: measured ○, fitted —")
    axes.set_xlabel("θₒ in the plane of incidence [°]")
    axes.set(xticks=(-60, -30, 0, 30, 60), ylim=(0.004, 200))
    axes.legend(loc="lower center", ncols=3, fontsize=8, frameon=False)
    axes.spines[["top", "right"]].set_visible(False)


def find_lobe_widths(fit):
    """Return the names of the fit's lobe widths, without parameters that follow another one."""
    parameters = fit.model.parameters.items()
    return [name for name, p in parameters if name.endswith("alpha_u") and not p.follows]


if __name__ == "__main__":
    draw_entrance().savefig(PICTURE, pil_kwargs={"quality": 90})
