"""The plots of a material's page: their arrays beside other evaluations, and their messages."""

import numpy as np
import pytest

import brdfkit as bk
from brdfkit.core.colours import luminance
from brdfkit.core.geometry.directions import from_angles, from_half_difference
from brdfkit.rendering.scenes._studio import BALL
from brdfkit.viewing.materials.application import MaterialApplication
from brdfkit.viewing.materials.curves import Curve, list_curves
from brdfkit.viewing.materials.material_scene import make_studio_camera
from brdfkit.viewing.materials.pins import COLOURS, add_pin, select_values
from brdfkit.viewing.materials.plots import albedo, lobe, polar, scatter, selection, slices
from brdfkit.viewing.materials.plots.ball import place_ball
from brdfkit.viewing.materials.plots.live_plots import PLOTS
from brdfkit.viewing.materials.plots.sampler import compute_density
from brdfkit.viewing.materials.plots.settings import PlotSettings
from brdfkit.viewing.session import Session

SHOWN = [name for name in PLOTS if name != "selection"]
GGX = {"alpha_u": 0.15, "specular_reflectance": [0.3, 0.2, 0.1]}


@pytest.fixture(scope="module")
def paint(module_in_llvm):
    return bk.load("car_paint")


@pytest.fixture
def model(module_in_llvm):
    return bk.models()["ggx"](**GGX)


@pytest.fixture
def scattered(model):
    """Samples of the model at an incidence of 30°, in the plane of incidence up to 60°."""
    theta = np.radians(np.arange(-60, 61, 5.0))
    wi = np.broadcast_to(from_angles(np.radians(30), 0.3), (len(theta), 3))
    wo = from_angles(theta, 0.3 + np.pi)
    return bk.Measured.from_samples(wi, wo, model.eval(wi, wo), name="goniometer")


def read(packed, data):
    """The arrays of a message, as the page reads them."""
    numbers = np.frombuffer(data, "<f4")
    if isinstance(packed, dict) and packed.keys() == {"at", "shape"}:
        size = int(np.prod(packed["shape"]))
        return numbers[packed["at"] : packed["at"] + size].reshape(packed["shape"])
    if isinstance(packed, dict):
        return {name: read(inner, data) for name, inner in packed.items()}
    return [read(inner, data) for inner in packed] if isinstance(packed, list) else packed


def test_lobes_are_the_brdf_in_the_plane_of_the_views(model):
    settings = PlotSettings(theta_i=50, phi_i=20, phi_o=30, cosine=True)
    lobe = polar.compute_lobe(model, settings)
    content = polar.arrange_lobes([(Curve("ggx", "#000000", model), lobe)], settings)
    (shown,) = content["lobes"]
    for degrees in (-60.0, 0.0, 50.0):
        k = int(np.flatnonzero(shown["theta_o"] == degrees)[0])
        wi = from_angles(np.radians([50]), np.radians([20]))
        azimuth = 20 + 180 + 30 if degrees >= 0 else 20 + 30
        wo = from_angles(np.radians([abs(degrees)]), np.radians([azimuth]))
        expected = luminance(model.eval(wi, wo))[0] * np.cos(np.radians(degrees))
        assert shown["values"][0, k] == pytest.approx(expected)
    each = polar.arrange_lobes([(Curve("", "", model), lobe)], PlotSettings(channel="each"))
    np.testing.assert_array_equal(each["lobes"][0]["values"].T, lobe["values"])


def test_samples_near_the_incidence_are_points_and_the_rest_is_unknown(scattered):
    lobe = polar.compute_lobe(scattered, PlotSettings(theta_i=31))
    np.testing.assert_allclose(np.sort(lobe["points"]), np.arange(-60, 61, 5), atol=1e-4)
    at = {round(float(p)): v for p, v in zip(lobe["points"], lobe["point_values"], strict=True)}
    forward = scattered.samples.wo[:, 0] * np.cos(0.3) < 0
    right = forward & (np.abs(scattered.samples.wo[:, 2] - np.cos(np.radians(30))) < 1e-9)
    np.testing.assert_array_equal(at[30], scattered.values[right][0])
    known = dict(zip(lobe["theta_o"], lobe["known"], strict=True))
    assert (known[-50.0], known[40.0], known[85.0]) == (True, True, False)
    assert len(polar.compute_lobe(scattered, PlotSettings(theta_i=70))["points"]) == 0
    across = polar.compute_lobe(scattered, PlotSettings(theta_i=30, phi_o=90))
    assert np.abs(across["points"]).max() < 4  # azimuths near the normal mean nothing


def test_a_table_has_points_and_unknown_angles(paint):
    lobe = polar.compute_lobe(paint, PlotSettings(theta_i=70))
    assert len(lobe["points"]) > 50
    near = np.abs(lobe["points"] - 70) < 1.5
    assert np.median(luminance(lobe["point_values"])[near]) == pytest.approx(
        float(luminance(lobe["values"]).max()), rel=0.5
    )
    grazing = polar.compute_lobe(paint, PlotSettings(theta_i=88))
    assert 0 < grazing["known"].sum() < len(grazing["known"])
    text = polar.describe_lobes(
        [Curve("paint", "#000000", paint)],
        polar.arrange_lobes([(Curve("", "", paint), lobe)], PlotSettings(theta_i=70)),
    )
    assert text.startswith("Lobes for light at 70°. paint: largest at 7")


def test_the_density_of_the_sampler_integrates_to_one(model):
    z, phi = np.meshgrid((np.arange(400) + 0.5) / 400, (np.arange(800) + 0.5) / 800 * 2 * np.pi)
    wo = from_angles(np.arccos(z.ravel()), phi.ravel())
    wi = np.broadcast_to(from_angles(0.5, 0.0), wo.shape)
    assert compute_density(model, wi, wo).mean() * 2 * np.pi == pytest.approx(1, abs=0.02)
    rough = bk.models()["lambert"](diffuse_reflectance=0.3)
    lobe = polar.compute_lobe(rough, PlotSettings(sampler=True))
    shown = polar.arrange_lobes([(Curve("", "", rough), lobe)], PlotSettings(sampler=True))
    np.testing.assert_allclose(
        shown["lobes"][0]["sampler"], shown["lobes"][0]["values"][0], rtol=1e-5
    )


def test_slices_are_the_brdf_and_its_ratio_to_the_data(paint, model):
    settings = PlotSettings(phi_d=60, channel="G")
    curves = [Curve("paint", "", paint), Curve("ggx", "", model)]
    content = slices.arrange_slices(
        [(c, slices.compute_slice(c.material, settings)) for c in curves], settings
    )
    data, fitted, ratio = content["panels"]
    theta_h, theta_d = slices.make_cells()
    for d, h in ((10, 5), (40, 30)):
        angles = (np.radians([a]) for a in (theta_h[h], theta_d[d], 60))
        wi, wo = from_half_difference(*angles)
        expected = [thing.eval(wi, wo)[0, 1] for thing in (paint, model)]
        assert [data["values"][d, h], fitted["values"][d, h]] == pytest.approx(expected)
        assert ratio["values"][d, h] == pytest.approx(np.log2(expected[1] / expected[0]))
    assert 0 < data["known"].sum() < data["known"].size
    inside = slices.compute_slice(model, PlotSettings(phi_d=0))
    assert 0.1 < np.isnan(inside["values"]).mean() < 0.6  # a direction below the surface
    assert "typically a factor of" in slices.describe_slices(curves, content)


def test_albedos_are_those_of_a_finer_quadrature(paint, model):
    curve = albedo.compute_albedo_curve(model, PlotSettings())
    k = albedo.THETA_I.index(45.0)
    assert curve["values"][k] == pytest.approx(
        bk.albedo(model, from_angles(np.radians(45), 0.0)), rel=5e-3
    )
    assert curve["known"].all()
    measured = albedo.compute_albedo_curve(paint, PlotSettings())
    assert measured["values"][k].mean() == pytest.approx(paint.albedo.means[1], rel=0.02)
    assert measured["known"][k]


def test_samples_are_measured_ones_beside_the_model(scattered, model):
    settings = PlotSettings()
    curves = [Curve("data", "", scattered), Curve("ggx", "", model)]
    drawn = scatter.draw_samples(scattered, settings)
    content = scatter.arrange_samples(list(zip(curves, [drawn, {}], strict=True)), settings)
    assert len(content["values"]) == 25
    np.testing.assert_allclose(content["models"][0]["ratio"], 0, atol=1e-9)
    np.testing.assert_allclose(np.sort(content["values"]), np.sort(luminance(scattered.values)))
    assert scatter.draw_samples(model, settings) == {}


def test_samples_of_a_table_are_even_over_the_half_vector(paint):
    drawn = scatter.draw_samples(paint, PlotSettings())
    counts = np.histogram(np.sqrt(drawn["theta_h"] / 90), bins=10, range=(0, 1))[0]
    assert len(drawn["theta_h"]) == scatter.MOST_SAMPLES
    assert counts[:8].min() > 0.5 * counts.max()
    assert np.isfinite(drawn["noise"]).all()


def test_the_solid_lobe_is_largest_in_the_mirror_direction(model):
    settings = PlotSettings(theta_i=40, phi_i=15)
    content = lobe.arrange_solid_lobes(
        [(Curve("ggx", "", model), lobe.compute_solid_lobe(model, settings))], settings
    )
    (shown,) = content["lobes"]
    row, column = np.argwhere(shown["theta_o"] == 40)[0, 0], np.argwhere(shown["phi_o"] == 0)[0, 0]
    wi, wo = (from_angles(np.radians([40]), np.radians([phi])) for phi in (15, 195))
    assert shown["values"][row, column] == pytest.approx(luminance(model.eval(wi, wo))[0])
    at = np.unravel_index(shown["values"].argmax(), shown["values"].shape)
    assert (abs(shown["theta_o"][at[0]] - 40) < 7, shown["phi_o"][at[1]]) == (True, 0)


def test_a_selection_lists_the_samples_within_its_ranges(scattered, model):
    ranges = (("view", 20.0, 40.0), ("theta_i", 29.0, 31.0), ("plane", 0.0, 5.0))
    settings = PlotSettings(selection=ranges)
    brighter = model.changed(specular_reflectance=[0.6, 0.4, 0.2], diffuse_reflectance=0.8)
    curves = [Curve("data", "", scattered), Curve("ggx", "", brighter)]
    evaluated = [(c, selection.select_pairs(c.material, settings)) for c in curves]
    content = selection.arrange_selection(evaluated, settings)
    theta = np.degrees(np.arccos(scattered.samples.wo[:, 2]))
    mirror = scattered.samples.wo[:, 0] * np.cos(0.3) < 0
    inside = mirror & (theta > 19.9) & (theta < 40.1)
    assert content["count"] == inside.sum() == 5
    assert content["medians"][0] == pytest.approx(np.median(scattered.values[inside], axis=0))
    assert content["ratios"] == pytest.approx([1, 2])
    pinned = [*evaluated, (Curve("1: ggx", "", model), {})]
    rows = selection.arrange_selection(pinned, settings)["rows"]
    assert [row["ratio"] for row in rows] == pytest.approx([2] * 5)  # of the shown model
    angles = {tuple(row["angles"]) for row in content["rows"]}
    assert (30.0, 30.0, 0.0, 30.0) in angles  # the mirror direction
    assert np.sort(content["marks"]["view"]) == pytest.approx([20, 25, 30, 35, 40], abs=1e-6)


def test_a_selection_without_samples_has_interpolated_values(scattered, model):
    settings = PlotSettings(theta_i=45, selection=(("view", 69.5, 70.5),))
    evaluated = [(Curve("ggx", "", model), {})]
    content = selection.arrange_selection(evaluated, settings)
    assert (content["count"], content["rows"][0]["angles"][:2]) == (0, [45.0, 70.0])
    nowhere = PlotSettings(selection=(("theta_h", 80.0, 81.0),))
    curve = Curve("data", "", scattered)
    empty = selection.arrange_selection(
        [(curve, selection.select_pairs(scattered, nowhere))], nowhere
    )
    assert selection.describe_selection([curve], empty) == "Nothing was measured there."


@pytest.mark.quick
@pytest.mark.parametrize("size", [(400, 400), (600, 300), (300, 500)])
def test_the_ball_is_placed_where_the_camera_sees_it(size):
    camera = make_studio_camera()
    found = place_ball(camera, size)
    aspect, eye = size[0] / size[1], camera.to_world[:3, 3]
    forwards = (np.array(BALL) - eye) / np.linalg.norm(np.array(BALL) - eye)
    right = np.cross(forwards, [0, 0, 1])
    for inner in np.radians([0, 30, 60]):  # at the ball's centre
        normal = np.sin(inner) * right / np.linalg.norm(right) - np.cos(inner) * forwards
        point = np.array(BALL) + normal
        view = (eye - point) / np.linalg.norm(eye - point)
        ray = np.arcsin(found["ratio"] * np.linalg.norm(np.cross(normal, view)))
        x, y, _ = camera.project(point[None], aspect)[0]
        expected = found["x"] + found["across"] * np.tan(ray), found["y"]
        assert (x, y) == pytest.approx(expected, abs=2e-3)


@pytest.fixture(scope="module")
def session(module_in_llvm):
    """A session that has sent its first plots."""
    application = MaterialApplication("car_paint", ["ggx"], {"view.scale": 0.25})
    # Pictures take the time of a kernel, and are not what is tested
    application.render = lambda state, side, size, moving, seed: np.full((*size[::-1], 3), 0.5)
    own = Session(application)
    own.handle({"type": "hello", "width": 64, "height": 64, "state": None})
    draw(own)
    return own


def draw(session):
    """Draw the plots that are stale; return their messages by name."""
    drawn = {}
    while session.application.has_plot(session.state, session.moving):
        messages = session.application.draw_plots(session.state, session.moving)
        drawn |= {message["plot"]: (message, data) for message, data in messages}
    return drawn


def change(session, moving=False, **changes):
    named = {name.replace("__", "."): value for name, value in changes.items()}
    session.handle({"type": "set", "changes": named, "moving": moving})


def test_only_open_plots_are_drawn_and_only_when_they_change(session):
    change(session, light__turn=20, tone__exposure=2)
    assert draw(session) == {}
    change(session, **{f"plots__show__{name}": name == "polar" for name in SHOWN})
    change(session, model__alpha_u=0.4)
    drawn = draw(session)
    assert list(drawn) == ["polar"]
    message, (data,) = drawn["polar"]
    assert [c["name"] for c in message["curves"]] == ["car_paint", "ggx"]
    assert [c["measured"] for c in message["curves"]] == [True, False]
    lobes = read(message["lobes"], data)
    expected = polar.compute_lobe(
        session.application.states.to_model(session.state), PlotSettings()
    )
    np.testing.assert_allclose(lobes[1]["values"][0], luminance(expected["values"]), rtol=1e-5)
    ranges = [["theta_h", 1.0, 2.0], ["theta_d", 40.0, 45.0]]
    change(session, plots__selection=ranges, **{f"plots__show__{name}": True for name in SHOWN})
    texts = {name: message["text"] for name, (message, _) in draw(session).items()}
    assert texts.keys() == PLOTS.keys() - {"polar"}  # which the page has already
    assert all("car_paint" in text or "ggx" in text for text in texts.values()), texts
    change(session, moving=True, model__alpha_u=0.3)
    assert set(draw(session)) == {name for name, plot in PLOTS.items() if plot.quick}
    closed = {f"plots__show__{name}": name == "polar" for name in SHOWN}
    change(session, plots__selection=[], **closed)
    draw(session)
    session.application.follow({}, session.state)  # a page that was loaded again
    assert "polar" in draw(session)


def test_a_change_of_plots_renders_no_picture(session):
    while session.stale or session.application.has_plot(session.state, False):
        session.work()
        session.handle({"type": "shown", "number": session.number})
    session.paused, number = True, session.number
    change(session, moving=True, plots__theta_i=20)
    (message, _), *others = session.work()
    assert (message["type"], message["theta_i"], others) == ("plot", 20, [])
    assert (session.has_work(), session.number) == (False, number)
    session.paused = False


@pytest.mark.parametrize("steps", [1, 2])  # of work between two changes
def test_plots_and_pictures_take_turns_while_a_slider_moves(session, steps):
    kinds = []
    for alpha in (0.2, 0.25, 0.3, 0.35):
        change(session, moving=True, model__alpha_u=alpha)
        session.handle({"type": "shown", "number": session.number})
        kinds += [session.work()[0][0]["type"] for _ in range(steps)]
    first, second = kinds[:2]
    assert ({first, second}, kinds) == ({"plot", "picture"}, [first, second] * (2 * steps))
    change(session, model__alpha_u=0.1)  # the end of the drag
    session.handle({"type": "shown", "number": session.number})
    assert session.work()[0][0]["type"] == "picture"


@pytest.mark.parametrize(
    "wrong", ["all", [["theta_x", 0, 1]], [["theta_h", 0]], [["view", 0, "a"]]]
)
def test_an_impossible_selection_is_a_sentence(session, wrong):
    answers = session.handle({"type": "set", "changes": {"plots.selection": wrong}})
    assert "list of ranges" in answers[0][0]["text"]


def test_pins_are_curves_and_one_can_be_alone(session):
    states, state = session.application.states, session.application.first
    pins = add_pin([], "ggx", select_values(state), "")
    pins = add_pin(pins, "ggx", select_values(state) | {"model.alpha_u": 0.7}, "")
    curves = list_curves(states, state | {"pins": pins})
    assert [c.name for c in curves] == ["car_paint", "ggx", "1: ggx", "2: ggx"]
    assert [c.colour for c in curves][2:] == list(COLOURS[:2])
    assert len({c.colour for c in curves}) == 4
    assert [c.twin for c in curves] == [False, False, True, False]
    assert curves[3].material.alpha_u == 0.7
    alone = list_curves(states, state | {"pins": pins, "solo": "pin2"})
    assert [c.name for c in alone] == ["car_paint", "2: ggx"]
    evaluated = [(c, slices.compute_slice(c.material, PlotSettings())) for c in curves]
    content = slices.arrange_slices(evaluated, PlotSettings())
    assert [panel["title"] for panel in content["panels"]] == [*("car_paint", "ggx", "ggx / data")]
