"""Draws an `Audit` with matplotlib: a slice of the BRDF's table, polar plots and the albedo."""

from types import SimpleNamespace
from typing import Any

import numpy as np
from matplotlib import rc_context
from matplotlib.figure import Figure

from brdfkit.core.array_types import BoolArray, FloatArray
from brdfkit.core.colours import RGB, luminance
from brdfkit.core.figures import Plot
from brdfkit.materials.auditing.albedos import Albedo
from brdfkit.materials.auditing.report import to_percent
from brdfkit.materials.measured import Measured
from brdfkit.materials.measured.coverage import is_near_sample
from brdfkit.materials.measured.evidence import GUESSED, INFERRED
from brdfkit.materials.measured.spectrum_to_rgb import to_rgb_or_mean
from brdfkit.materials.plotting.lobe_plots import draw_lobe_panels
from brdfkit.materials.plotting.plane_of_incidence import choose_angles
from brdfkit.model.samples import Table

SIZE = 12.6, 6.8  # inches
GREY = "0.45"  # colour of legend entries that belong to no single channel
COLOURS = {"R": "#d55e00", "G": "#009e73", "B": "#0072b2"}  # of channels; all others are black
TICKS = np.array([0, 1, 5, 10, 20, 40, 60, 90])  # theta_h [degrees] at the ticks of its axis
# The axis of the albedo reaches to the albedo of the samples alone, but at most to this multiple of
# the interpolated BRDF's albedo
LARGEST_RATIO = 4
FAINT_OPACITY = 0.35  # opacity of cells that were not measured


def draw_audit(audit: Any) -> Figure:
    """Draw the slice, the albedo and the polar plots of an `Audit` in one matplotlib `Figure`."""
    data = to_rgb_or_mean(audit.data)
    figure: Any = Plot(figsize=SIZE, layout="constrained")
    layout: Any = figure.get_layout_engine()
    layout.set(w_pad=0.1, h_pad=0.1)
    above, below = figure.subfigures(2, 1, height_ratios=(1, 1.06))
    _draw_title(figure, audit)
    slice_axes, albedo_axes = above.subplots(1, 2, width_ratios=(1.25, 1))
    _draw_slice(above, slice_axes, data)
    _draw_albedo(albedo_axes, audit)
    things: list[Any] = [data]
    if not data.is_table:
        things.append(SimpleNamespace(name="interpolated", eval=data.eval))
    draw_lobe_panels(below, things, choose_angles(things))
    return figure


def _draw_title(figure: Figure, audit: Any) -> None:
    """Write the material's name, kind of data and coverage above the picture."""
    how = "in valid cells" if audit.data.is_table and audit.data.evidence is None else "measured"
    covered = f"{to_percent(audit.coverage.measured)} of the direction pairs {how}"
    text = f"{audit.name}: {audit.kind}, {audit.valid:,} valid, {covered}"
    # Escape the dollar sign, which begins a formula in matplotlib's texts
    figure.suptitle(text.replace("$", r"\$"), fontsize=12)


def _draw_slice(figure: Any, axes: Any, data: Measured) -> None:
    """Draw the BRDF's luminance over theta_h and theta_d at phi_d ≈ 90°; hatch unmeasured cells."""
    # Select the cells at phi_d ≈ 90°
    table = data.table
    across = int(np.argmin(np.abs(table.centres[-1] - np.pi / 2)))
    cells = (0,) * table.anisotropic + (slice(None), slice(None), across)
    values = luminance(table.filled_values[cells])
    known = find_measured_cells(data, table, cells)

    # Draw the cells; the axis is linear in the square root of theta_h, in which the cells are even
    axes.patch.set(facecolor="0.92", hatch="////", edgecolor="0.75", linewidth=0)
    norm = make_colour_scale(values[known] if known.any() else values)
    image = axes.imshow(
        np.maximum(values, 0.99 * norm.vmin).T,  # a logarithmic scale would leave zeros blank
        norm=norm,
        alpha=np.where(known, 1, FAINT_OPACITY).T,
        extent=(0, 1, 0, 90),
        origin="lower",
        aspect="auto",
        interpolation="nearest",
    )
    completed = data.evidence is not None
    if completed:
        _hatch_evidence(axes, data, cells)
    axes.set_xticks(np.sqrt(TICKS / 90), [f"{t}°" for t in TICKS])
    axes.set_yticks(range(0, 91, 30), [f"{t}°" for t in range(0, 91, 30)])
    axes.set_xlabel(r"$\theta_h$")
    axes.set_ylabel(r"$\theta_d$")

    # Add the title and the colour bar
    phi_d = np.degrees(table.centres[-1][across])
    hatched = "" if known.all() else "; hatched: not measured"
    if completed:
        hatched = "\nthin stripes: inferred; faint, dense stripes: guessed"
    what = "luminance" if data.channels in (RGB, ("Y",)) else "mean"
    axes.set_title(rf"{what} of the BRDF [sr⁻¹] at $\phi_d$ = {phi_d:.0f}°{hatched}", fontsize=10)
    bar = figure.colorbar(image, ax=axes, pad=0.02, extend="both")
    bar.ax.yaxis.set_major_formatter("{x:g}")
    if image.norm.vmax < 10 * image.norm.vmin:
        bar.ax.yaxis.set_minor_formatter("{x:.2g}")


def _hatch_evidence(axes: Any, data: Measured, cells: Any) -> None:
    """Hatch the inferred and the guessed cells of a slice of a completed table."""
    assert data.evidence is not None
    kinds = data.evidence.reshape(data.table.shape)[cells].astype(float)
    kinds[~np.isfinite(data.table.values[cells]).all(axis=-1)] = np.nan
    n_h, n_d = kinds.shape
    h, d = (np.arange(n_h) + 0.5) / n_h, (np.arange(n_d) + 0.5) / n_d * 90
    with rc_context({"hatch.linewidth": 0.5}):
        for kind, pattern in ((INFERRED, "/"), (GUESSED, "\\\\\\\\")):
            mask = np.where(kinds == kind, 1.0, 0.0).T
            if mask.any():
                filled = axes.contourf(
                    h, d, mask, levels=[0.5, 1.5], colors="none", hatches=[pattern]
                )
                filled.set(edgecolor="0.35", linewidth=0)


def find_measured_cells(data: Measured, table: Table, cells: Any) -> BoolArray:
    """Return a mask of the cells of a table that were measured, or are near a measured sample.

    Of a completed table, inferred cells count, too. `cells` is an index of the table, which selects
    a slice.
    """
    if data.evidence is not None:
        above = np.isfinite(table.values[cells]).all(axis=-1)
        return above & (data.evidence.reshape(table.shape)[cells] != GUESSED)
    if data.is_table:
        return np.isfinite(table.values[cells]).all(axis=-1)
    wi, wo = (w[cells].reshape(-1, 3) for w in table.directions())
    return is_near_sample(data, wi, wo).reshape(table.values[cells].shape[:-1])


def make_colour_scale(values: FloatArray) -> Any:
    """Make a logarithmic colour scale for `values`, without the lowest and the highest 1 %."""
    from matplotlib.colors import LogNorm

    positive = values[values > 0]
    if not positive.size:
        return LogNorm(0.1, 1)
    lowest, highest = np.percentile(positive, (1, 99))
    return LogNorm(min(lowest, highest / 2), highest)


def _draw_albedo(axes: Any, audit: Any) -> None:
    """Draw the albedo over theta_i: lines for the interpolated BRDF, circles for samples alone."""
    # Draw lines, dotted where the BRDF is extrapolated
    albedo, samples = audit.albedo, audit.albedo_of_samples
    measured = albedo.theta_i <= albedo.measured_to + 1
    last = int(np.flatnonzero(measured)[-1])
    for channel, values in zip(albedo.channels, albedo.values.T, strict=True):
        style = {"color": COLOURS.get(channel, "black"), "linewidth": 1.8}
        label = channel if len(albedo.channels) > 1 else None
        axes.plot(albedo.theta_i[measured], values[measured], label=label, **style)
        axes.plot(albedo.theta_i[last:], values[last:], linestyle=":", **style)
    if not measured.all():
        axes.plot([], ":", color=GREY, linewidth=1.8, label="extrapolated")

    # Draw circles for the samples alone; the axis of the albedo ends at `top`
    top = 1.12 * albedo.values.max() or 1.0
    if samples:
        top = max(top, 1.12 * min(samples.values.max(), LARGEST_RATIO * albedo.values.max()))
        _draw_sample_albedo(axes, samples, top)
    if top > 0.9:
        axes.axhline(1, color="0.6", linewidth=0.8, zorder=0)

    axes.set(xlim=(0, 90), ylim=(0, top))
    axes.set_xticks(range(0, 91, 15), [f"{t}°" for t in range(0, 91, 15)])
    axes.set_xlabel(r"$\theta_i$")
    axes.spines[["top", "right"]].set_visible(False)
    axes.set_title("albedo", fontsize=10)
    if axes.get_legend_handles_labels()[1]:
        axes.legend(loc="upper left", bbox_to_anchor=(1, 1), frameon=False, handlelength=1.2)


def _draw_sample_albedo(axes: Any, samples: Albedo, top: float) -> None:
    """Draw circles at the albedos of the samples; those above `top` or below 0 become triangles."""
    # Triangles of several channels stand side by side, a few degrees of theta_i apart
    beside = 2.0 * (np.arange(len(samples.channels)) - (len(samples.channels) - 1) / 2)
    for channel, values, aside in zip(samples.channels, samples.values.T, beside, strict=True):
        style = {"linestyle": "", "color": COLOURS.get(channel, "black")}
        for marker, outside in (("^", values > top), ("v", values < 0)):
            edge = np.full(outside.sum(), (0.97 if marker == "^" else 0.03) * top)
            axes.plot(samples.theta_i[outside] + aside, edge, marker=marker, **style)
        inside = (values >= 0) & (values <= top)
        axes.plot(samples.theta_i[inside], values[inside], marker="o", mfc="none", **style)
    axes.plot([], "o", color=GREY, mfc="none", label="samples alone")
    if np.any((samples.values > top) | (samples.values < 0)):
        axes.plot([], "^", color=GREY, label="out of range")
