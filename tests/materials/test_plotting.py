"""Plots: the right directions and values, measured ones only where measured; nothing overlaps."""

import itertools

import numpy as np
import pytest
from matplotlib.backends.backend_agg import FigureCanvasAgg

from brdfkit import models
from brdfkit.core.colours import luminance
from brdfkit.core.errors import BrdfkitError
from brdfkit.core.figures import Plot
from brdfkit.core.geometry.directions import from_angles
from brdfkit.images.thumbnails import Radius
from brdfkit.materials.measured import Measured
from brdfkit.materials.plotting import plot
from brdfkit.materials.plotting.plane_of_incidence import compute_lobe

GREY, RED = (0.2, 0.2, 0.2), (0.5, 0.0, 0.0)


class Constant:
    """The least that `plot` takes."""

    def __init__(self, value, name="constant"):
        self.value, self.name = value, name

    def eval(self, wi, wo):
        return np.full((len(wi), 1), self.value)


class Spike(Constant):
    """`value` in the mirror direction, 10⁻³ elsewhere."""

    def eval(self, wi, wo):
        mirror = np.sum(wi * [-1, -1, 1] * wo, axis=1) > np.cos(np.radians(3))
        return np.where(mirror, self.value, 1e-3)[:, None]


def table(name="table", value=0.2, known=lambda theta_h: theta_h < 10):
    values = np.full((30, 15, 30, 3), value)
    theta_h = ((np.arange(30) + 0.5) / 30) ** 2 * np.pi / 2
    values[~known(theta_h)] = np.nan
    return Measured.from_table(values, name=name)


def scattered(rows, valid=None, name="scattered"):
    """From rows (theta_i, phi_i, theta_o, phi_o [degrees], value)."""
    theta_i, phi_i, theta_o, phi_o, value = np.array(rows, float).T
    wi, wo = from_angles(*np.radians([theta_i, phi_i])), from_angles(*np.radians([theta_o, phi_o]))
    return Measured.from_samples(wi, wo, value[:, None], valid=valid, channels=("Y",), name=name)


def texts(figure):
    """The bounding boxes [pixels] of all that is written in a figure."""
    canvas = FigureCanvasAgg(figure)
    canvas.draw()
    renderer = canvas.get_renderer()
    written = [t for axes in figure.axes for t in (*axes.texts, axes.title)]
    written += figure.legends[0].get_texts()
    return {t: t.get_window_extent(renderer) for t in written if t.get_text() and t.get_visible()}


@pytest.mark.quick
@pytest.mark.parametrize("theta_i", [0, 45, 80])
def test_a_model_is_drawn_as_it_evaluates(theta_i):
    model = models()["ggx"](specular_reflectance=RED, diffuse_reflectance=GREY, alpha_u=0.1)
    theta_o, values = compute_lobe(model, theta_i)
    assert np.allclose(np.diff(theta_o), 0.1)
    assert theta_o[0] == pytest.approx(-89.9)
    assert theta_o[-1] == pytest.approx(89.9)
    wi = np.broadcast_to(from_angles(np.radians(theta_i), 0.3), (len(theta_o), 3))
    wo = from_angles(np.radians(theta_o), 0.3 + np.pi)  # right of the normal: the mirror's side
    assert np.allclose(values, model.eval(wi, wo) @ [0.2126, 0.7152, 0.0722])
    assert abs(theta_o[np.argmax(values)] - theta_i) < 10


@pytest.mark.quick
def test_luminance():
    assert np.allclose(luminance(np.array([[1.0, 1, 1], [0, 1, 0]])), [1, 0.7152])
    assert luminance(np.array([[3.0]])).tolist() == [3]
    with pytest.raises(BrdfkitError, match="4 channels"):
        luminance(np.ones((2, 4)))


@pytest.mark.quick
def test_a_table_is_drawn_only_where_it_was_measured():
    material = table(known=lambda theta_h: theta_h < np.radians(20))
    theta_o, values = compute_lobe(material, 30)
    theta_h = np.abs(theta_o - 30) / 2
    assert np.allclose(values[theta_h < 18], 0.2)
    assert np.isnan(values[theta_h > 24]).all()


@pytest.mark.quick
def test_scattered_samples_are_drawn_only_near_the_plane():
    rows = [
        (45, 0, 30, 180, 1),  # the mirror's side
        (43, 10, 20, 14, 2),  # the light's side, near enough
        (45, 0, 0, 77, 3),  # the normal has no azimuth
        (45, 0, 30, 90, 4),  # across
        (49, 0, 30, 180, 5),  # another incidence
        (45, 0, 50, 180, 6),  # masked
    ]
    theta_o, values = compute_lobe(scattered(rows, valid=np.arange(6) != 5), 45)
    assert np.allclose(np.abs(theta_o[2]), 0)
    assert np.allclose(theta_o[:2], [30, -20])
    assert values.tolist() == [1, 2, 3]


@pytest.mark.quick
def test_usual_angles_are_those_measured():
    assert titles(plot(Constant(1))) == ["15°", "45°", "75°"]
    material = scattered([(t, 0, 30, 180, 1) for t in (10, 20, 40, 60)] + [(75, 0, 30, 90, 1)])
    assert titles(plot([Constant(1), material])) == ["10°", "40°", "60°"]
    assert titles(plot(scattered([(45, 0, 30, 90, 1)]))) == ["15°", "45°", "75°"]
    assert titles(plot(material, theta_i=33.5)) == ["33.5°"]


def titles(figure):
    return [axes.get_title().split("= ")[1] for axes in figure.axes]


@pytest.mark.quick
def test_legend_and_styles_tell_all_apart():
    things = [table("paint"), scattered([(45, 0, 30, 180, 1)]), table("paint")]
    things += [Constant(0.1 * k, "model") for k in range(1, 9)]
    figure = plot(things, theta_i=45)
    labels = [t.get_text() for t in figure.legends[0].get_texts()]
    assert labels[:3] == ["paint", "scattered", "paint (2)"]
    assert labels[3:5] == ["model", "model (2)"]
    lines = {line.get_label(): line for line in figure.axes[0].lines}
    looks = [
        (lines[n].get_color(), lines[n].get_linestyle(), lines[n].get_marker()) for n in labels
    ]
    assert len(set(looks)) == len(labels) == 11
    assert looks[0] == ("black", "-", "None")
    assert looks[1][1:] == ("None", "o")
    assert not any(color == "black" for color, *_ in looks[1:])


@pytest.mark.parametrize("peak", [1e-3, 0.05, 3, 2e3, 1e7])
@pytest.mark.parametrize("theta_i", [(0,), (15, 45, 75), (5, 30, 60, 89)])
def test_nothing_overlaps(peak, theta_i):
    things = [Spike(peak, name) for name in ("gold-metallic-paint", "cook_torrance", "ggx", "ward")]
    figure = plot(things, theta_i=theta_i)
    boxes = texts(figure)
    for (one, a), (other, b) in itertools.combinations(boxes.items(), 2):
        assert not a.overlaps(b), (one.get_text(), other.get_text())
    page = figure.bbox
    assert all(
        a.x0 >= 0 and a.y0 >= 0 and a.x1 <= page.x1 and a.y1 <= page.y1 for a in boxes.values()
    )
    legend = figure.legends[0].get_window_extent()
    assert not any(axes.get_window_extent().overlaps(legend) for axes in figure.axes)


@pytest.mark.quick
@pytest.mark.parametrize("darkest", [0.0101, 0.014, 0.02, 0.099])
@pytest.mark.parametrize("decades", [0.1, 1, 2, 4])
def test_what_is_darkest_stays_off_the_centre(darkest, decades):
    """A lobe whose dark side is at the centre is a wedge: both sides of its line meet."""
    values = np.geomspace(darkest, darkest * 10**decades, 1000)
    assert Radius([values])(darkest) > 0.15


@pytest.mark.quick
@pytest.mark.parametrize("peak", [1e-3, 0.32, 1, 2e3, 1e9])
def test_the_scale_holds_the_largest_and_its_ticks(peak):
    values = np.geomspace(peak / 1e3, peak, 1000)
    radius = Radius([values, np.array([np.nan, 0, -1])])
    assert 0.95 < radius(peak) < 1
    assert np.all(np.diff(radius(values[30:])) > 0)
    assert radius(np.array([0.0, -1.0])).tolist() == [0, 0]
    assert np.isnan(radius(np.array([np.nan]))).all()
    ticks = radius.ticks()
    assert 2 <= len(ticks) <= 5
    assert radius(ticks[0]) == 0
    assert radius(ticks[-1]) <= 1
    assert np.allclose(np.log10(ticks) % 1, 0)


@pytest.mark.parametrize(
    "thing", [Constant(0.0), table(value=0.0), Constant(1 / np.pi), Constant(np.inf)]
)
def test_black_uniform_and_infinite_materials(thing):
    FigureCanvasAgg(plot(thing)).draw()


@pytest.mark.quick
def test_spectral_data_is_drawn_in_colour():
    wi, wo = from_angles([0.3, 0.3], 0.0), from_angles([0.3, 0.6], np.pi)
    channels = tuple(f"{w}nm" for w in range(400, 701, 50))
    material = Measured.from_samples(wi, wo, np.full((2, 7), 0.4), channels=channels)
    line = next(x for x in plot(material).axes[0].lines if x.get_label() == "samples")
    assert len(line.get_xdata()) == 2


def test_no_global_state_and_shown_in_notebooks():
    import matplotlib.pyplot as plt

    before = plt.get_fignums()
    figure = plot(Constant(1, "a $ sign and another $"))
    assert isinstance(figure, Plot)
    assert plt.get_fignums() == before
    assert figure._repr_png_().startswith(b"\x89PNG")


@pytest.mark.quick
@pytest.mark.parametrize("theta_i", [-1, 90, (10, np.nan), (), [[1, 2]]])
def test_angles_out_of_range(theta_i):
    with pytest.raises(BrdfkitError, match="from 0 to below 90°"):
        plot(Constant(1), theta_i=theta_i)


@pytest.mark.quick
@pytest.mark.parametrize(
    ("things", "named"),
    [
        ([], "No material was given"),
        (3, r"3 \(int\) is no material"),
        (None, "None"),
        ([Constant(1), 3], "3"),
        (Constant, "<class"),
    ],
)
def test_what_cannot_be_plotted(things, named):
    with pytest.raises(BrdfkitError, match=f"^{named}.*; give "):
        plot(things)
