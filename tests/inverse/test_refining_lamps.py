"""`refine` of photographs under lamps of their own: lamps are switched, and their places found."""

import json

import drjit as dr
import numpy as np
import pytest
from click.testing import CliRunner
from refined_scenes import LAMPS, TRUTH, TRUTH_BSDF, require_back, shoot, under_lamps

import brdfkit as bk
from brdfkit.cli import main
from brdfkit.core.jit.threads import use_two_threads
from brdfkit.inverse.scenes.problem.by_picture import choose_sensors
from brdfkit.inverse.scenes.problem.lamps import Lighting
from brdfkit.inverse.scenes.problem.parameters import choose_unknowns
from brdfkit.inverse.scenes.problem.places import Place
from brdfkit.inverse.scenes.problem.scene import load_scene, make_integrator
from brdfkit.inverse.scenes.problem.targets import read_targets
from brdfkit.inverse.scenes.problem.views import Views
from brdfkit.inverse.scenes.search.backward_derivatives import compute_error_and_gradient
from brdfkit.inverse.scenes.search.forward_derivatives import compute_derivatives
from brdfkit.inverse.scenes.search.gauss_newton import Search, _turns_back
from brdfkit.inverse.scenes.search.normal_equations import Equations

ALPHA, DIFFUSE = "ball.bsdf.alpha_u", "ball.bsdf.diffuse_reflectance"
SUN = np.array([0.3, 0.8, -1]) / np.linalg.norm([0.3, 0.8, -1])
BLACK = {"type": "area", "radiance": 0.0}
LIGHTS = {f"under_{name}": name for name in LAMPS}


@pytest.fixture(scope="module")
def pictures(mi):
    """The scene at the truth under each of its lamps, in turn."""
    return {f"under_{name}": shoot(mi, under_lamps(mi), [name]) for name in LAMPS}


def views(mi, scene, pictures, parameters, lights=LIGHTS):
    loaded = load_scene(scene, (16, 16))
    names, targets = mi.traverse(loaded), read_targets(pictures)
    lighting = Lighting(names, lights, tuple(pictures))
    chosen = choose_unknowns(names, parameters)
    return Views(loaded, make_integrator(loaded), targets, names, chosen, None, lighting)


def test_each_picture_has_its_lamps_alone(mi, pictures):
    """As bright and as quiet as without the other lamps, by one kernel for all pictures."""
    glow = {"type": "bitmap", "raw": True, "bitmap": mi.Bitmap(np.ones((2, 2, 3), np.float32))}
    lamp = {"type": "sphere", "radius": 0.2, "emitter": {"type": "area", "radiance": glow}}
    sky = {"type": "envmap", "bitmap": mi.Bitmap(np.ones((4, 8, 3), np.float32))}
    dark = under_lamps(mi, sky=sky, bulb={**lamp, "center": [0.8, -0.9, 1.2]})
    found = views(mi, dark, pictures, [ALPHA, "point.intensity"])
    before = {key: np.array(value) for key, value in found.parameters if "lamp" in key}
    with dr.scoped_set_flag(dr.JitFlag.KernelHistory):
        found.render_pixels(found.start, 16, 0, [0])
        dr.kernel_history_clear()
        one, other = (found.render_pixels(found.start, 256, seed) for seed in (0, 50))
        kernels = dr.kernel_history([dr.KernelType.JIT])
    # the first change of each kind of lamp compiles a kernel of a few operations
    renderings = [kernel for kernel in kernels if kernel["operation_count"] > 1000]
    assert len(renderings) == 2 * len(LAMPS)
    assert all(kernel["cache_hit"] for kernel in renderings)
    alone = {**dark, "bulb": {**dark["bulb"], "emitter": BLACK}}
    del alone["sky"]
    for name, a, b in zip(LAMPS, *map(found.split_pictures, (one, other)), strict=True):
        own = {k: v for k, v in alone.items() if k not in LAMPS or k == name}
        own["panel"] = dark["panel"] if name == "panel" else {**dark["panel"], "emitter": BLACK}
        scene = mi.load_dict(own)
        c, d = (np.array(mi.render(scene, spp=256, seed=seed)) for seed in (7, 90))
        assert (a + b).mean() == pytest.approx((c + d).mean(), rel=0.02), name
        assert np.std(a - b) < 1.2 * np.std(c - d), name
    found.write_to_scene(found.start)
    for key, value in before.items():
        np.testing.assert_array_equal(np.array(found.parameters[key]), value)


def test_derivatives_are_those_of_finite_differences(mi, pictures):
    names = [ALPHA, "point.intensity", "spot.to_world", "sun.to_world"]
    found = views(mi, under_lamps(mi), pictures, names)
    x, spp = found.start, 512
    by_number = compute_derivatives(found, x, spp, 3)
    assert found.names[4:] == ("spot.to_world[0]", "spot.to_world[1]", "spot.to_world[2]",
                               "sun.to_world[0]", "sun.to_world[1]")  # fmt: skip
    for number, step, lit in ((0, 0.01, None), (1, 0.5, 0), (4, 0.06, 1), (8, 0.02, 2)):
        there, here = (x + sign * step * np.eye(len(x))[number] for sign in (1, -1))
        change = found.render_residuals(there, spp, 3) - found.render_residuals(here, spp, 3)
        if number == 1:  # the derivative by red is that of the red channel
            change[:, 1:] = 0
        expected = change / (2 * step)
        along = (by_number[number] * expected).sum() / (expected**2).sum()
        assert along == pytest.approx(1, abs=0.03)
        if lit is not None:
            for i, part in enumerate(found.split_pictures(by_number[number])):
                assert bool(part.any()) == (i == lit)


def test_derivatives_backwards_reach_lamps(mi, pictures):
    """Beside thousands of numbers, the places of lamps have differences of the loss."""
    some = {name: pictures[name] for name in ("under_point", "under_spot")}
    names = ["point.position", "spot.intensity"]
    found = views(mi, under_lamps(mi), some, names, {name: LIGHTS[name] for name in some})
    x, spp = found.start + 0.05, 64
    gradient = compute_error_and_gradient(found, x, spp, 3, found.weights)[1]
    for number, step in ((0, 0.05), (3, 0.3)):
        errors = []
        for sign in (1, -1):
            at = x + sign * step * np.eye(len(x))[number]
            a, b = (found.render_residuals(at, spp, 3 + 1000 * half) for half in (0, 1))
            errors.append((found.weights * a * b).sum())
        assert gradient[number] == pytest.approx((errors[0] - errors[1]) / (2 * step), rel=0.1)


def test_materials_and_places_of_lamps_come_back(mi, pictures):
    """And a lamp that no photograph shows is predicted."""
    begin = under_lamps(
        mi,
        TRUTH | {"alpha_u": 0.25, "diffuse_reflectance": (0.5,) * 3},
        point={
            "type": "point",
            "position": [1, -2.3, 2.6],
            "intensity": {"type": "rgb", "value": [9] * 3},
        },
        sun={
            "type": "directional",
            "direction": [0.2, 0.9, -1],
            "irradiance": {"type": "rgb", "value": [2] * 3},
        },
    )
    known = {name: picture for name, picture in pictures.items() if name != "under_spot"}
    lights = {name: LIGHTS[name] for name in known}
    names = [ALPHA, DIFFUSE, "point.position", "sun.to_world"]
    scene = mi.load_dict(begin, optimize=False)
    found = bk.refine(scene, known, parameters=names, lights=lights, starts=1, spp=64)
    require_back(found, {ALPHA: TRUTH["alpha_u"], DIFFUSE: TRUTH["diffuse_reflectance"]})
    for name, truth in (("point.position", [1.2, -2.2, 2.4]), ("sun.to_world", SUN)):
        error = np.array(found.standard_errors[name])
        assert (np.abs(np.subtract(found.values[name], truth)) < 3.5 * error).all(), name
        assert (error < 0.03).all(), name
    assert np.linalg.norm(found.values["sun.to_world"]) == pytest.approx(1)
    assert found.names == tuple(known)
    assert "spot burns in no picture" in found.notes
    assert found.look("under_sun").pictures.keys() == {"given", "found"}
    # all lamps burn in the scene that refine leaves behind
    everything = np.array(mi.render(scene, spp=64))
    sum_of_all = sum(pictures.values())
    assert everything.mean() == pytest.approx(sum_of_all.mean(), rel=0.03)
    spot = found.put_into(under_lamps(mi))
    Lighting(mi.traverse(spot), ["spot"], ("spot",)).switch(0, {})
    mi.traverse(spot).update()
    predicted = np.array(mi.render(spot, spp=256))
    held_out = pictures["under_spot"]
    assert np.sqrt(((predicted - held_out) ** 2).mean()) < 0.03 * held_out.max()


def test_two_cameras_take_pictures_in_any_order(mi):
    aside = mi.ScalarTransform4f().look_at([3, -2.6, 1.8], [0, 0, 0.7], [0, 0, 1])
    scene = under_lamps(mi)
    scene["side"] = {**scene["sensor"], "to_world": aside}
    ids = [sensor.id() for sensor in mi.load_dict(scene).sensors()]
    taken = {"a": ("side", "point"), "b": ("sensor", "sun"), "c": ("side", "panel")}
    pictures = {
        name: shoot(mi, scene, [lamp], ids.index(camera)) for name, (camera, lamp) in taken.items()
    }
    scene["ball"]["bsdf"] = {**TRUTH_BSDF, "alpha_u": 0.25}
    how = {"lights": {n: lamp for n, (_, lamp) in taken.items()}, "starts": 1, "spp": 64}
    cameras = {name: camera for name, (camera, _) in taken.items()}
    require_back(
        bk.refine(scene, pictures, parameters=[ALPHA], cameras=cameras, **how),
        {ALPHA: TRUTH["alpha_u"]},
    )
    by_id = choose_sensors(mi.load_dict(scene), ("side", "sensor"), None, True)
    assert [sensor.id() for sensor in by_id] == ["side", "sensor"]
    with pytest.raises(bk.BrdfkitError, match="name the camera of each in cameras, of "):
        bk.refine(scene, pictures, parameters=[ALPHA], **how)


def test_clipped_and_black_photographs_do_not_stop_a_search(mi, pictures):
    """Each channel clips at a value of its own, and dark pictures do not decide."""
    bright = pictures["under_sun"]
    clipped = np.minimum(bright, np.quantile(bright, 0.7, axis=(0, 1)))
    photographs = {
        **pictures,
        "under_sun": clipped,
        "under_panel": 0 * bright,
        "under_spot": np.ones_like(bright),
    }
    targets = {target.name: target for target in read_targets(photographs)}
    assert targets["under_sun"].clipped == pytest.approx(0.3, abs=0.01)
    assert not targets["under_panel"].weights.any()
    begin = under_lamps(mi, TRUTH | {"alpha_u": 0.25})
    found = bk.refine(begin, photographs, parameters=[ALPHA], lights=LIGHTS, starts=1, spp=32)
    require_back(found, {ALPHA: TRUTH["alpha_u"]})
    notes = " ".join(found.notes)
    assert "picture under_panel: black throughout, so does not count" in notes
    assert "picture under_spot: clipped throughout, so does not count" in notes


BAD = {
    "an unknown lamp": ({"lights": {**LIGHTS, "under_sun": "moon"}}, "no lamp 'moon'"),
    "no lamp": ({"lights": {**LIGHTS, "under_sun": []}}, "no lamp burns in under_sun; name"),
    "a picture without": ({"lights": {"under_sun": "sun"}}, "no lamp burns in under_point"),
    "an unknown picture": ({"lights": {**LIGHTS, "under_moon": "sun"}}, "no picture 'under_moon'"),
    "too few": ({"lights": ["sun"]}, "one list of lamps for each picture: 1 for 4"),
    "an unknown camera": ({"lights": LIGHTS, "cameras": ["eye"] * 4}, "no camera 'eye'"),
    "an unknown mask": ({"lights": LIGHTS, "mask": {"sun": None}}, "no picture 'sun'"),
    "all burn": ({}, "one picture for each sensor: 4 for 1"),
    "a ball's place": ({"parameters": ["ball.to_world"], "lights": LIGHTS}, "cannot be searched"),
}


@pytest.mark.parametrize("case", BAD)
def test_bad_lights_are_one_sentence(mi, pictures, case):
    how, says = BAD[case]
    with pytest.raises(bk.BrdfkitError, match=says) as error:
        bk.refine(under_lamps(mi), pictures, **how)
    assert "\n" not in str(error.value)


def test_an_error_leaves_all_lamps_burning(mi, pictures):
    scene = mi.load_dict(under_lamps(mi), optimize=False)

    def stop(*at):
        raise RuntimeError("stop")

    how = {"lights": LIGHTS, "starts": 1, "spp": 4, "progress": stop}
    with pytest.raises(RuntimeError, match="stop"):
        bk.refine(scene, pictures, parameters=[ALPHA, "point.intensity"], **how)
    names = mi.traverse(scene)
    assert [names[f"{name}.sampling_weight"] for name in LAMPS[:3]] == [1, 1, 1]
    assert np.array(names["point.intensity.value"]).max() == pytest.approx(9)


def test_steps_that_undo_the_last_one_are_too_long():
    """Searches for a lamp's place went back and forth for 17 steps, with the same samples."""
    nothing = np.zeros((2, 1))
    equations = Equations(np.zeros(2), np.eye(2), nothing, np.array([1.0, 4.0]))
    state = Search(residuals=None, equations=equations, last_step=np.array([1.0, 1.0]))
    assert _turns_back(np.array([-0.1, -0.9]), state)
    assert not _turns_back(np.array([-0.9, -0.1]), state)
    assert not _turns_back(np.array([0.9, 0.9]), state)
    assert not _turns_back(np.array([-1.0, -1.0]), Search(residuals=None, equations=equations))


def test_a_direction_is_a_unit_vector():
    matrix = np.eye(4)
    matrix[:3, 2] = -SUN
    place = Place(matrix, 2)
    numbers = place.start + np.array([0.1, -0.05])
    vector = place.to_vector(numbers)
    assert np.linalg.norm(vector) == pytest.approx(1)
    assert vector[2] > 0  # as the third component of -SUN
    slopes = [(place.to_vector(numbers + step)[2] - vector[2]) / 1e-6 for step in 1e-6 * np.eye(2)]
    np.testing.assert_allclose(place.differentiate_dependent(numbers), slopes, rtol=1e-4)
    assert np.isfinite(place.to_vector(np.array([3.0, 4.0]))).all()


SCENE = """<scene version="3.0.0"><integrator type="direct"/><sensor type="perspective">
<film type="hdrfilm"><integer name="width" value="8"/><integer name="height" value="8"/>
<string name="pixel_format" value="rgb"/><rfilter type="box"/></film><float name="fov" value="40"/>
<transform name="to_world"><lookat origin="0,0,4" target="0,0,0" up="0,1,0"/></transform></sensor>
<shape type="sphere" id="ball"><bsdf type="lambert">
<rgb name="diffuse_reflectance" value="COLOUR"/></bsdf></shape>
<emitter type="point" id="left"><point name="position" x="-3" y="0" z="4"/>
<rgb name="intensity" value="LEFT"/></emitter>
<emitter type="point" id="right"><point name="position" x="3" y="0" z="4"/>
<rgb name="intensity" value="RIGHT"/></emitter></scene>"""


def test_the_command_finds_values(mi, tmp_path, monkeypatch):
    """Names are those of the files; what is found is printed and written, or said in a sentence."""
    monkeypatch.chdir(tmp_path)

    def scene(colour, left, right):
        words = {"COLOUR": colour, "LEFT": left, "RIGHT": right}
        text = SCENE
        for word, value in words.items():
            text = text.replace(word, str(value))
        return text

    for name, lamps in (("a", (20, 0)), ("b", (0, 20))):
        with use_two_threads():
            picture = mi.render(mi.load_string(scene("0.6,0.3,0.1", *lamps)), spp=64)
            mi.Bitmap(picture).write(f"{name}.exr")
    (tmp_path / "scene.xml").write_text(scene("0.5,0.5,0.5", 20, 20))

    def run(*words):
        found = CliRunner().invoke(main, ["refine", "scene.xml", "a.exr", "b.exr", *words])
        return found.exit_code, found.stdout if found.exit_code == 0 else found.output

    lights = "--lights", "a=left", "--lights", "b=right"
    status, said = run(*lights, "--spp", "64", "--json", "-o", "found")
    assert status == 0, said
    record = json.loads(said)
    name = "ball.bsdf.diffuse_reflectance"
    assert record["values"][name] == pytest.approx([0.6, 0.3, 0.1], rel=0.03)
    names = {path.rsplit("/", 1)[-1] for path in record["written"]}
    assert names == {"refined.json", "ball.bsdf.json", "look_a.png", "look_b.png"}
    assert json.loads((tmp_path / "found" / "refined.json").read_text())["names"] == ["a", "b"]
    assert bk.load(tmp_path / "found" / "ball.bsdf.json").values["diffuse_reflectance"]
    for words, says in (
        (("--lights", "a"), "should read PICTURE=LAMP"),
        (("--lights", "a=left"), "no lamp burns in b"),
        ((*lights, "--parameter", f"{name}=1"), "should read"),
        ((*lights, "--mask", "c=a.exr"), "no picture 'c'"),
    ):
        status, said = run(*words)
        assert status == 2
        assert says in said
