"""`plot`: the lobes of BRDFs in the plane of incidence, measured and modelled."""

import io
import math
from collections.abc import Iterable
from itertools import cycle

import numpy as np
from matplotlib.figure import Figure
from numpy.typing import ArrayLike

from brdfkit.colours import luminance
from brdfkit.errors import BrdfkitError
from brdfkit.geometry.directions import from_angles, to_angles
from brdfkit.materials import MaterialLike, materials
from brdfkit.measured import Measured
from brdfkit.names import make_unique
from brdfkit.plotting.half_disc import Radius, half_disc, xy
from brdfkit.samples import Table

STEP = 0.1  # degrees between the points of a line
NEAR_THETA, NEAR_PHI = 3, 5  # degrees: samples this close to the plane are drawn in it

BLACK, GREY = "black", "0.45"
# Okabe and Ito's colours, which the colour-blind tell apart
COLOURS = ("#d55e00", "#0072b2", "#009e73", "#cc79a7", "#e69f00", "#56b4e9")
DASHES = ("-", "--", "-.", ":")
MOST_COLUMNS = 3


def plot(things: MaterialLike | Iterable[MaterialLike], theta_i: ArrayLike | None = None) -> Figure:
    """Polar plots of BRDFs in the plane of incidence, one panel per angle of incidence.

    The radius is logarithmic in the BRDF [sr⁻¹], in its luminance where it has colour; what is
    too dark for the scale lies in the centre. Light comes from the left, along the arrow. The
    first measured material is black: a table a line, where it was measured, and scattered samples
    dots, those within 3° of theta_i and 5° of the plane.

    Parameters
    ----------
    things : Measured, Fit, Model, str, Path or dict, or several
        The materials, or the names or paths of them, or BSDFs' dictionaries.
    theta_i : float or array_like, optional
        Angles of incidence [degrees], from 0 to below 90. By default 15, 45 and 75, or the nearest
        ones at which the first scattered material was measured.

    Returns
    -------
    matplotlib.figure.Figure
        Not pyplot's: a notebook shows it, ``savefig`` writes it.

    Raises
    ------
    BrdfkitError
        For angles out of range, for values that are neither achromatic nor RGB, and for what is no
        material.

    Examples
    --------
    >>> plot(["car_paint", "ward"]).savefig("paint.png")    # doctest: +SKIP
    """
    found = _things(things)
    angles = usual_angles(found) if theta_i is None else np.atleast_1d(theta_i).astype(float)
    if angles.ndim != 1 or not angles.size or not np.all((angles >= 0) & (angles < 90)):
        raise BrdfkitError(f"plot: theta_i = {theta_i} should be angles from 0 to below 90°.")
    return _figure(found, angles)


class Plot(Figure):
    """A matplotlib `Figure` that is not pyplot's: no window, no global state.

    Notebooks show it, also where pyplot has not told them how.
    """

    def _repr_png_(self):
        png = io.BytesIO()
        self.savefig(png, format="png", dpi=100)
        return png.getvalue()


def lobe(thing, theta_i):
    """What `plot` draws at `theta_i` [degrees]: angles to the normal and luminances, both (n,).

    The angles [degrees] are negative on the light's side. The luminance [sr⁻¹] is NaN where
    a table was not measured, or where a model has no finite value.
    """
    if _scattered(thing):
        return _samples_near(thing.samples, theta_i)
    theta_o = np.linspace(-90, 90, round(180 / STEP) + 1)[1:-1]
    wi = np.broadcast_to(from_angles(np.radians(theta_i), np.pi), (len(theta_o), 3))
    wo = from_angles(np.radians(theta_o), 0.0)
    values = luminance(thing.eval(wi, wo))
    known = np.isfinite(values)
    if isinstance(thing, Measured):
        known &= _was_measured(thing.table, wi, wo)
    return theta_o, np.where(known, values, np.nan)


def _things(things):
    found = materials(things, needed=("name", "eval"))
    return [thing.rgb if isinstance(thing, Measured) else thing for thing in found]


def usual_angles(things):
    """15°, 45° and 75° or, where there are scattered samples, the nearest angles of theirs."""
    usual = np.array([15.0, 45.0, 75.0])
    scattered = next((thing for thing in things if _scattered(thing)), None)
    if scattered is None:
        return usual
    there = to_angles(scattered.samples.wi[_in_plane(scattered.samples)])[0]
    there = np.unique(np.degrees(there).round(1))
    there = there[there < 90]
    if not there.size:
        return usual
    return np.unique([there[np.argmin(np.abs(there - angle))] for angle in usual])


def _scattered(thing):
    return isinstance(thing, Measured) and not thing.is_table


def _in_plane(samples):
    """Which samples are valid and within `NEAR_PHI` of the plane of incidence."""
    beside = np.abs(_turned(samples)) >= np.cos(np.radians(NEAR_PHI))
    return samples.valid & (beside | (samples.wo[:, 2] == 1))


def _turned(samples):
    """cos Δφ: 1 in the light's azimuth, -1 in the mirror's."""
    return np.cos(to_angles(samples.wo)[1] - to_angles(samples.wi)[1])


def _samples_near(samples, theta_i):
    near = np.abs(np.degrees(to_angles(samples.wi)[0]) - theta_i) <= NEAR_THETA
    near &= _in_plane(samples)
    theta_o = -np.sign(_turned(samples)) * np.degrees(to_angles(samples.wo)[0])
    return theta_o[near], luminance(samples.values[near])


def _was_measured(table, wi, wo):
    """Where a lookup rests on measured cells by more than half."""
    known = np.isfinite(table.values).all(axis=-1, keepdims=True)
    return Table(known.astype(float), table.phi_d_period).eval(wi, wo)[:, 0] > 0.5


def _figure(things, angles):
    rows, columns = _grid(angles)
    figure = Plot(figsize=(max(4.2 * columns, 6), 2.75 * rows + 0.35), layout="constrained")
    figure.get_layout_engine().set(h_pad=0.08)
    draw(figure, things, angles)
    return figure


def _grid(angles):
    """Rows and columns of the panels."""
    rows = math.ceil(len(angles) / MOST_COLUMNS)
    return rows, math.ceil(len(angles) / rows)


def draw(figure, things, angles):
    """Draw the panels and their legend into a matplotlib `Figure` or `SubFigure`.

    `things` are achromatic or RGB, `angles` those of incidence [degrees].
    """
    rows, columns = _grid(angles)
    styles = _styles(things)
    for place, theta_i in enumerate(angles, 1):
        _panel(figure.add_subplot(rows, columns, place), theta_i, things, styles)
    handles, labels = figure.axes[0].get_legend_handles_labels()
    ncols = min(len(labels), columns + 2)
    figure.legend(handles, labels, loc="outside lower center", ncols=ncols, frameon=False)


def _styles(things):
    """Keywords of matplotlib's `plot` for each thing; no two look or are called the same."""
    colours = [{"color": c, "linestyle": dash} for dash in DASHES for c in COLOURS]
    palette, styles, taken = cycle(colours), [], set()
    black = next((thing for thing in things if isinstance(thing, Measured)), None)
    for thing in things:
        style = {"color": BLACK, "linestyle": "-"} if thing is black else next(palette)
        style = {**style, "linewidth": 1.4}
        if isinstance(thing, Measured):  # thick, and under the models' lines
            style |= {"linewidth": 2.4, "zorder": 1.9}
        if _scattered(thing):
            style |= {"linestyle": "", "marker": "o", "markersize": 3}
        style["label"] = make_unique(thing.name.replace("$", r"\$"), taken)  # $ begins a formula
        taken.add(style["label"])
        styles.append(style)
    return styles


def _panel(axes, theta_i, things, styles):
    """Half a disc, the normal upwards: the lobes at one angle of incidence."""
    lobes = [lobe(thing, theta_i) for thing in things]
    radius = Radius([values for _, values in lobes])
    half_disc(axes, radius)
    axes.set_title(rf"$\theta_i$ = {theta_i:g}°", size=11)
    arrow = {"arrowstyle": "-|>", "color": GREY, "shrinkA": 0, "shrinkB": 0}
    axes.annotate("", (0, 0), xy(-theta_i, 1), arrowprops=arrow, zorder=1.5)
    for (theta_o, values), style in zip(lobes, styles, strict=True):
        axes.plot(*xy(theta_o, radius(values)), **style)
