"""Pictures: repeatable, unbiased in their seeds, rightly exposed; written whole or not at all."""

import json
from types import SimpleNamespace

import drjit as dr
import numpy as np
import pytest

import brdfkit as bk
from brdfkit.core import memory
from brdfkit.core.colours import luminance
from brdfkit.core.errors import BrdfkitError
from brdfkit.distance_fields import plane, sphere
from brdfkit.images.errors.metrics import METRICS
from brdfkit.rendering import Rendering, render
from brdfkit.rendering.montage import draw_montage
from brdfkit.rendering.scene_input.loading import load_scenes
from brdfkit.rendering.scenes.ball import ball
from brdfkit.rendering.tracing import divide_into_passes

pytestmark = pytest.mark.usefixtures("module_in_llvm")

WHITE = {"name": "white", "type": "diffuse", "reflectance": 0.8}
GREY = {"name": "grey", "type": "diffuse", "reflectance": 0.2}


@pytest.fixture(scope="module")
def pair():
    return render([WHITE, GREY], spp=8, size=32)


def test_equal_seeds_give_equal_pictures(pair):
    again = render([WHITE, GREY], spp=8, size=32)
    other = render([WHITE, GREY], spp=8, size=32, seed=1)
    for name, picture in pair.pictures.items():
        assert picture.shape == (32, 32, 3)
        assert picture.dtype == np.float32
        np.testing.assert_allclose(again.pictures[name], picture, rtol=1e-5, atol=1e-6)
        assert np.abs(other.pictures[name] - picture).max() > 1e-3


def test_all_pictures_share_their_samples():
    twice = render([WHITE, WHITE, ("other", GREY)], spp=4, size=16)
    assert list(twice.pictures) == ["white", "white (2)", "other"]
    assert np.abs(twice.differences["white (2)"]).max() < 1e-5
    assert twice.psnr()["white (2)"] > 80


def test_all_pictures_are_made_by_one_kernel(module_in_llvm):
    """What is compiled for the first material is compiled for all of them."""
    materials = {f"{share}": {"type": "diffuse", "reflectance": share} for share in (0.2, 0.8)}
    scenes, _ = load_scenes(materials, "ball", (8, 8))
    kernels = []
    with dr.scoped_set_flag(dr.JitFlag.KernelHistory):
        for scene in scenes.values():
            dr.kernel_history_clear()
            dr.eval(module_in_llvm.render(scene, spp=1))
            kernels.append({kernel["hash"] for kernel in dr.kernel_history([dr.KernelType.JIT])})
    assert kernels[0]
    assert kernels[0] == kernels[1]


def test_seeds_agree_in_the_mean():
    """Two independent sets of 12 pictures; |t| > 4 comes by chance once in 1,600 (22 d.o.f.)."""
    renderings = [render(WHITE, spp=4, size=16, seed=s) for s in range(24)]
    means = [r.pictures["white"][r.mask].mean() for r in renderings]
    first, second = np.reshape(means, (2, 12))
    error = np.sqrt((first.var(ddof=1) + second.var(ddof=1)) / 12)
    assert error > 0
    assert abs(first.mean() - second.mean()) < 4 * error


def test_white_paint_is_exposed_right():
    """Nothing clips, and the brightest part comes out near sRGB 200 (0.58 linear).

    48 pixels at 64 spp: the noise of a pixel is about 1 %, the tolerance 12 %.
    """
    white = render(WHITE, spp=64, size=48)
    lit = white.pictures["white"][white.mask]
    assert lit.max() < 1
    assert np.percentile(lit, 99) == pytest.approx(0.58, rel=0.12)
    assert lit.min() > 0.02  # no black rim


def test_a_white_furnace_returns_the_sky():
    """A ball of reflectance 1 under a sky of radiance 1 all around is as bright as the sky.

    A convex ball sees nothing else, so that one bounce tells all.
    """

    def furnace(bsdf, size):
        scene = ball(bsdf, size)
        del scene["sky"], scene["softbox"], scene["ground"]
        return scene | {"sky": {"type": "constant", "radiance": 1.0}}

    white = {"type": "diffuse", "reflectance": 1.0}
    picture = render(white, spp=256, size=16, scene=furnace).pictures["diffuse"]
    # the noise of a pixel at 256 spp is below 2 %, of the mean of 256 pixels below 0.2 %
    assert picture.mean() == pytest.approx(1, abs=0.01)


@pytest.mark.quick
@pytest.mark.parametrize("spp", [1, 2, 7, 32, 64, 100])
def test_passes_add_up(spp):
    passes = list(divide_into_passes(spp, 32))
    assert sum(passes) == spp
    assert max(passes) <= 32


def test_an_exr_reads_back_with_names_and_header(tmp_path):
    import OpenEXR

    rendering = render(
        [WHITE, bk.models()["lambert"](diffuse_reflectance=(0.8, 0.1, 0.1))], spp=5, size=16, seed=3
    )
    rendering.write(tmp_path / "both.exr")
    assert sorted(p.name for p in tmp_path.iterdir()) == ["both.exr", "both.png"]
    expected = rendering.pictures | {"difference: lambert": rendering.differences["lambert"]}
    expected["standard error: white"] = rendering.standard_error
    with OpenEXR.File(str(tmp_path / "both.exr"), separate_channels=True) as file:
        parts = {part.name(): part for part in file.parts}
        assert list(parts) == list(expected)
        for name, part in parts.items():
            read = np.stack([part.channels[c].pixels for c in "RGB"], axis=-1)
            assert read.dtype == np.float32
            np.testing.assert_array_equal(read, expected[name])
            assert (part.header["spp"], part.header["seed"]) == (5, 3)
            assert part.header["brdfkit"]
            assert part.header["noise_floor"] == pytest.approx(rendering.noise_floor)
        parameters = json.loads(parts["lambert"].header["parameters"])
        assert parameters == {"diffuse_reflectance": [0.8, 0.1, 0.1]}
        assert json.loads(parts["white"].header["parameters"]) == {}


@pytest.mark.quick
def test_a_rendering_says_its_errors_and_their_floor():
    reference = np.full((4, 4, 3), 0.5, np.float32)
    pictures = {"r": reference, "off": reference + np.float32(0.05), "same": reference}
    rendering = Rendering(pictures, spp=1, seconds=0.0)
    assert rendering.psnr()["off"] == pytest.approx(20, abs=1e-4)
    assert rendering.psnr()["same"] == np.inf
    assert "off   PSNR 20.0 dB\n" in str(rendering)
    noisy = Rendering(pictures, spp=2, seconds=0.0, other_seed=reference + np.float32(0.005))
    assert noisy.noise_floor == noisy.errors().floor["psnr"] == pytest.approx(40, abs=1e-4)
    assert "r     reference, noise 40.0 dB\n" in str(noisy)
    assert "off   PSNR 20.0 dB, noise 40.0 dB\n" in str(noisy)
    assert str(noisy).endswith("same  PSNR inf dB ≈ noise 40.0 dB")


def stop_at(pictures):
    """A progress that types Ctrl-C after so many pictures of passes."""

    def progress(done, total):
        if done == pictures:
            raise KeyboardInterrupt

    return progress


def test_an_interrupted_render_keeps_what_every_picture_has():
    # two passes of 16 spp × two pictures
    kept = render([WHITE, GREY], spp=32, size=16, progress=stop_at(3))
    assert (kept.spp, kept.requested) == (16, 32)
    assert np.isnan(kept.noise_floor)
    for thing in (WHITE, GREY):
        alone = render(thing, spp=32, size=16, progress=stop_at(1)).pictures[thing["name"]]
        np.testing.assert_allclose(kept.pictures[thing["name"]], alone, rtol=1e-5, atol=1e-6)


def test_samples_are_added_until_the_noise_is_low_enough():
    """The guess of how many it takes comes true; the pictures are those of so many samples."""
    totals = []
    found = render(
        [WHITE, GREY], noise_floor=38.0, size=32, progress=lambda done, total: totals.append(total)
    )
    passes = found.spp // 16
    assert found.requested == found.spp == 16 * passes
    assert 38 <= found.noise_floor == found.errors().floor["psnr"]
    assert len(totals) == 2 * passes
    assert totals[4] == pytest.approx(2 * passes, abs=2 + passes // 2)
    assert render([WHITE, GREY], spp=found.spp - 16, size=32).noise_floor < 38
    again = render([WHITE, GREY], spp=found.spp, size=32)
    np.testing.assert_allclose(again.pictures["grey"], found.pictures["grey"], rtol=1e-5, atol=1e-6)
    assert not found.shortfall


def test_a_noise_floor_that_takes_too_many_samples_is_said_to():
    found = render(WHITE, noise_floor=60, spp=16, size=16)
    assert found.requested == found.spp == 16
    needed = 16 * 10 ** ((60 - found.noise_floor) / 10)
    assert f"60 dB take about {float(f'{needed:.2g}'):,.0f} samples" in str(found)
    stopped = render(WHITE, noise_floor=60, spp=32, size=16, progress=stop_at(1))
    assert (stopped.spp, stopped.requested, stopped.shortfall) == (16, 32, "")
    hopeless = render(WHITE, noise_floor=1000, spp=2, size=8).shortfall
    assert hopeless.endswith("; 1000 dB take more than a billion samples per pixel.")


@pytest.mark.quick
def test_what_is_unknown_or_without_noise_is_captioned_so():
    grey = np.full((2, 2, 3), 0.5, np.float32)
    pictures = {"a": grey, "b": 0.5 * grey, "c": grey}
    exact = Rendering(pictures, 16, 1.0, other_seed=grey)
    assert list(exact.captions.values()) == [
        "reference, no noise",
        "PSNR 6.0 dB, no noise",
        "PSNR inf dB, no noise",
    ]
    unseen = Rendering(pictures, 16, 1.0, other_seed=grey, mask=np.full((2, 2), False))
    assert list(unseen.captions.values()) == ["reference", "PSNR unknown", "PSNR unknown"]


@pytest.mark.quick
@pytest.mark.parametrize("value", [1e38, -1e300])
def test_a_value_that_is_none_of_a_brdf_is_said(value):
    huge = bk.Measured.from_table(np.full((3, 3, 6, 1), value), channels=("Y",))
    with pytest.raises(BrdfkitError, match="is too large to be rendered"):
        render(huge, spp=1, size=4)


def test_an_equal_material_has_no_error():
    twice = render([WHITE, ("again", WHITE)], spp=2, size=16)
    assert not any(twice.errors().exceeds("again", metric) for metric in METRICS)
    assert "again  PSNR" in str(twice)
    assert " ≈ noise" in str(twice)
    assert np.isnan(render(WHITE, spp=1, size=16).noise_floor)


@pytest.mark.parametrize("size", [1e-4, 1e4])
def test_a_field_fills_its_picture(size):
    """Whatever its size; one part is of the material that it is named after, one is grey."""

    def picture(size):
        field = sphere(1).made_of("blasted_gold") | plane().at(0, 0, -1).made_of("nothing_known")
        return render(field.scale(size), size=24).pictures["field"]

    one, other = picture(1), picture(size)
    np.testing.assert_allclose(other.mean(), one.mean(), rtol=0.01)
    red, _, blue = other[10:14, 10:14].mean(axis=(0, 1))
    assert red > 2 * blue
    assert np.ptp(other[-1], axis=-1).max() < 0.02


def test_an_interrupt_before_the_first_pass_is_raised():
    def stop(done, total):
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        render([WHITE, GREY], spp=4, size=16, progress=stop)


@pytest.mark.quick
@pytest.mark.parametrize("path", ["missing/a.exr", "a.jpg", "a"])
def test_what_cannot_be_written_leaves_nothing(pair, tmp_path, path):
    with pytest.raises(BrdfkitError, match=path):
        pair.write(tmp_path / path)
    assert not list(tmp_path.iterdir())


@pytest.mark.quick
@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"materials": []}, "nothing to render"),
        ({"materials": 5}, r"5 \(int\) is no material"),
        ({"materials": ["car_pant"]}, r"did you mean car_paint\?"),
        ({"materials": bk.models()["ward"]}, r"Ward is a model without values; call it: Ward\(\)"),
        ({"materials": {"name": "it"}}, 'no "type"'),
        ({"materials": {"type": "no_such_bsdf"}}, "no_such_bsdf: Mitsuba cannot load it"),
        ({"materials": WHITE, "spp": 0}, "spp = 0"),
        ({"materials": WHITE, "spp": float("inf")}, "spp = inf"),
        ({"materials": WHITE, "spp": 1, "noise_floor": 45}, "spp = 1 .* at least 2"),
        ({"materials": WHITE, "noise_floor": 0}, "noise_floor = 0 should be a number above 0"),
        ({"materials": WHITE, "size": 0}, "pixels above 0"),
        ({"materials": WHITE, "size": (8,)}, "pixels above 0"),
        ({"materials": WHITE, "seed": 2**31}, "out of bounds"),
        ({"materials": WHITE, "seed": -1}, "seed = -1"),
        ({"materials": sphere(1), "scene": "knot"}, "leave scene and environment out"),
    ],
)
def test_what_cannot_be_rendered_is_said(arguments, message):
    with pytest.raises(BrdfkitError, match=message):
        render(**{"spp": 1, "size": 16} | arguments)


@pytest.mark.quick
def test_a_montage_holds_every_picture(pair, tmp_path):
    from PIL import Image

    pair.write(tmp_path / "pair.png")
    with Image.open(tmp_path / "pair.png") as image:
        assert image.size == draw_montage(pair).size
        assert image.width > 2 * 320  # small pictures are enlarged so that captions fit
    five = {f"a very long name of the material number {i}": np.ones((8, 8, 3)) for i in range(5)}
    broken = five | {"not finite": np.full((8, 8, 3), np.nan)}
    for pictures, rows in ((dict(list(five.items())[:4]), 1), (broken, 2)):
        page = draw_montage(Rendering(pictures, spp=1, seconds=0.0))
        assert page.width < 5 * 400
        assert 600 * rows < page.height < 900 * rows


@pytest.mark.quick
def test_pictures_by_a_curve():
    """Only what is shown changes; a curve up to the brightest is that of the reference."""
    pictures = {n: np.full((4, 4, 3), x, np.float32) for n, x in (("a", 4.0), ("b", 1.0))}
    linear = Rendering(pictures, spp=1, seconds=0.0)
    shown = linear.tone_mapped(bk.ToneMapping("logarithmic", exposure=2))
    assert "logarithmic × 2" in shown.captions["a"]
    before, after = (np.asarray(draw_montage(r)) for r in (linear, shown))
    middle = [(200, 200), (200, 540)]
    assert [before[p].tolist() for p in middle] == [[255] * 3] * 2
    assert after[middle[0]].tolist() == [255] * 3
    assert 100 < after[middle[1]][0] < 250


@pytest.mark.quick
def test_what_is_as_light_and_red_is_not_green():
    red = np.broadcast_to([0.4, 0.0, 0.0], (8, 8, 3))
    green = np.broadcast_to([0.0, 0.4 * 0.2126 / 0.7152, 0.0], (8, 8, 3))
    page = np.asarray(
        draw_montage(Rendering({"red": red, "green": green, "too": red}, 1, 0.0)), int
    )
    below = page[-100]  # the last pictures are the differences
    third = page.shape[1] // 3
    assert below[third + third // 2].sum() > 600  # of 765: as bright as they get
    assert below[2 * third + third // 2].sum() < 20


def test_a_scene_file_is_rendered(tmp_path):
    scene = """<scene version="3.0.0">
      <sensor type="perspective"><film type="hdrfilm">
        <integer name="width" value="12"/><integer name="height" value="8"/></film></sensor>
      <integrator type="path"/>
      <emitter type="constant"/></scene>"""
    (tmp_path / "empty.xml").write_text(scene)
    picture = render(tmp_path / "empty.xml", spp=2).pictures["empty"]
    np.testing.assert_allclose(picture, np.ones((8, 12, 3)), rtol=1e-5)
    with pytest.raises(BrdfkitError, match="no such file"):
        render(tmp_path / "missing.xml")
    (tmp_path / "cut.xml").write_text(scene.replace('<integrator type="path"/>', ""))
    with pytest.raises(BrdfkitError, match=r"cut\.xml: the scene has no integrator; add"):
        render(tmp_path / "cut.xml")


@pytest.mark.parametrize(
    ("sampler", "given", "spp"), [(7, {}, 7), (7, {"spp": None}, 7), (7, {"spp": 3}, 3)]
)
def test_a_scene_has_its_own_samples_per_pixel(tmp_path, sampler, given, spp):
    scene = tmp_path / "scene.xml"
    scene.write_text(
        f"""<scene version="3.0.0"><integrator type="path"/><emitter type="constant"/>
        <sensor type="perspective">
        <sampler type="independent"><integer name="sample_count" value="{sampler}"/></sampler>
        <film type="hdrfilm"><integer name="width" value="4"/><integer name="height" value="4"/>
        </film></sensor></scene>"""
    )
    rendering = render(scene, **given)
    assert (rendering.spp, rendering.requested) == (spp, spp)


def test_what_is_larger_than_the_memory_is_refused_before_any_is_taken(monkeypatch, tmp_path):
    def build(bsdf, size):
        raise AssertionError("a scene was made")

    free = SimpleNamespace(virtual_memory=lambda: SimpleNamespace(available=10**8))
    monkeypatch.setattr(memory, "psutil", free)
    said = "A picture of 1000×900 pixels would take about 0.2 GB .* 0.1 GB are available; give a s"
    with pytest.raises(BrdfkitError, match=said):
        render(WHITE, size=(1000, 900), scene=build)
    with pytest.raises(BrdfkitError, match="3 pictures of 500×500 pixels would take about"):
        render([WHITE, GREY, "ward"], size=500, scene=build)
    render(WHITE, spp=1, size=32)
    (tmp_path / "large.xml").write_text(
        """<scene version="3.0.0"><integrator type="path"/><sensor type="perspective">
        <film type="hdrfilm"><integer name="width" value="5000"/></film></sensor></scene>"""
    )
    with pytest.raises(BrdfkitError, match=r"large\.xml: a picture of 5000×.* would take about"):
        render(tmp_path / "large.xml", spp=1)


OTHER_VARIANTS = "llvm_ad_mono", "llvm_ad_spectral_polarized"


@pytest.fixture(scope="module")
def in_rgb():
    return render([WHITE, "ggx"], spp=64, size=32)


@pytest.mark.parametrize("variant", OTHER_VARIANTS)
def test_every_variant_exposes_alike(in_rgb, variant):
    """Both sides of the ball, and the ground and sky behind it, within 4 % in the mean."""
    import mitsuba as mi

    mi.set_variant(variant)
    try:
        rendering = render([WHITE, "ggx"], spp=64, size=32)
    finally:
        mi.set_variant("llvm_ad_rgb")
    left = np.arange(32) < 16
    for name, picture in rendering.pictures.items():
        found, expected = luminance(picture), luminance(in_rgb.pictures[name])
        for part in (in_rgb.mask & left, in_rgb.mask & ~left, ~in_rgb.mask):
            assert found[part].mean() == pytest.approx(expected[part].mean(), rel=0.04)
        if "mono" in variant:
            assert np.ptp(picture, axis=-1).max() == 0
