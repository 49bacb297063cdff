"""The integrator of volumes that glow and absorb: closed forms, order of convergence, gradients."""

import drjit as dr
import numpy as np
import pytest

from brdfkit.volumes import TransferFunction

SPP = 512  # of gradients, whose samples are others


def picture(mi, integrator, spp=1, **shapes):
    """The radiance along rays that go through the unit cube, front to back, with light behind."""
    return np.array(mi.render(scene(mi, integrator, **shapes), spp=spp))


def scene(mi, integrator, **shapes):
    camera = mi.ScalarTransform4f().look_at([0.5, 0.5, 3], [0.5, 0.5, 0], [0, 1, 0])
    camera = camera @ mi.ScalarTransform4f().scale(0.3)
    film = {"type": "hdrfilm", "width": 4, "height": 4, "rfilter": {"type": "box"}}
    return mi.load_dict(
        {
            "type": "scene",
            "integrator": {"type": "emission_absorption", **integrator},
            "sensor": {"type": "orthographic", "to_world": camera, "film": film},
            "behind": {"type": "constant", "radiance": 0.5},
            **shapes,
        }
    )


def exact(sigma, e, behind=0.5, n=200_000):
    """The radiance of σ(z), e(z) seen from z = 1 along -z, by fine quadrature."""
    z = 1 - (np.arange(n) + 0.5) / n
    depth = np.cumsum(sigma(z)) / n
    before = np.concatenate([[0], depth[:-1]])
    return np.sum(np.exp(-(before + depth) / 2) * e(z)) / n + np.exp(-depth[-1]) * behind


@pytest.mark.quick
@pytest.mark.parametrize("sigma", [0.0, 1e-6, 0.3, 20.0])
def test_an_even_volume_is_exact_in_one_step(llvm_variant, sigma):
    found = picture(llvm_variant, {"extinction": sigma, "emission": 0.8, "steps": 1})
    light = 0.8 * (-np.expm1(-sigma) / sigma if sigma else 1)
    np.testing.assert_allclose(found, light + 0.5 * np.exp(-sigma), rtol=1e-5)


def test_the_error_is_of_second_order(llvm_variant):
    """Twice the steps, a quarter of the error, for extinction and emission that change."""

    def sigma(z):
        return np.interp(z, [0.25, 0.75], [1.0, 5.0])

    def e(z):
        return np.interp(z, [0.25, 0.75], [3.0, 0.5])

    volumes = {}
    for name, f in {"extinction": sigma, "emission": e}.items():
        grid = f(np.array([0.25, 0.75])).astype(np.float32).reshape(2, 1, 1, 1)
        volumes[name] = {"type": "gridvolume", "grid": llvm_variant.VolumeGrid(grid)}
    truth = exact(sigma, e)
    errors = []
    for steps in (8, 16, 32):
        found = picture(llvm_variant, {**volumes, "steps": steps})
        errors.append(abs(float(found.mean()) - truth))
    assert errors[0] / errors[1] == pytest.approx(4, rel=0.15)
    assert errors[1] / errors[2] == pytest.approx(4, rel=0.15)


def coloured(mi, values, function):
    """A volume with a transfer function, of values (n,) along z, or (nz, ny, nx)."""
    values = np.asarray(values, np.float32)
    values = values.reshape(*(values.shape if values.ndim == 3 else (-1, 1, 1)), 1)
    grid = {"type": "gridvolume", "grid": mi.VolumeGrid(values)}
    return {"type": "transfer_function", "values": grid, "transfer": function.to_json()}


def test_the_errors_of_a_known_volume(llvm_variant):
    """[Lesar 2018, eq. 6.3] of σ = 0.25 + 1.5 s and e = 0.3 + sin²s from s = 0 to 2, 0.7 behind it.

    The radiance by quadrature, and the errors in as many steps by an implementation in NumPy.
    """
    mi = llvm_variant
    n = 16_384  # the values stay as they are beyond the outermost centres: these are at the faces
    s = 2 - 2 * (np.arange(n) + 0.5) / n  # seen from z = 1
    unit = 2  # the cube's edge has the length 1 here: σ and e are per twice the length
    rgba = [[0, 0, 0, 0.25 / 3.25], [0, 0, 0, 1]]
    sigma = coloured(mi, s, TransferFunction([0, 2], rgba, 3.25 * unit))
    e = (unit * (0.3 + np.sin(s) ** 2)).astype(np.float32).reshape(-1, 1, 1, 1)
    volumes = {"extinction": sigma, "emission": {"type": "gridvolume", "grid": mi.VolumeGrid(e)}}
    known = {8: -2.6e-3, 32: -1.6e-4, 128: -1.0e-5}
    errors = []
    for steps in known:
        found = picture(
            mi, {**volumes, "steps": steps}, behind={"type": "constant", "radiance": 0.7}
        )
        errors.append(float(found.mean()) - 0.567472)
    np.testing.assert_allclose(errors, list(known.values()), rtol=0.05, atol=1e-6)


@pytest.mark.quick
@pytest.mark.parametrize("colour", ["albedo", "emission"])
def test_a_transfer_function_glows(llvm_variant, colour):
    """An even volume: RGB (1 - exp(-σ)), and light of other emission."""
    mi = llvm_variant
    rgba = [[0.9, 0.5, 0.1, 0.5]] * 2
    glow = coloured(mi, [1.0], TransferFunction([0, 2], rgba, 3, colour))
    found = picture(mi, {"extinction": glow, "emission": 0.4, "steps": 3})
    seen = -np.expm1(-1.5)
    expected = np.array([0.9, 0.5, 0.1]) * seen + 0.4 * seen / 1.5 + 0.5 * (1 - seen)
    np.testing.assert_allclose(found, np.broadcast_to(expected, found.shape), rtol=1e-5)


@pytest.mark.quick
@pytest.mark.parametrize("steps", [1, 7])
@pytest.mark.parametrize("jitter", [False, True])
def test_a_peak_that_is_thinner_than_a_step(llvm_variant, steps, jitter):
    """RGB (1 - T) + T L, T = exp(-∫ σ): exact, as the values are linear along the ray."""
    mi = llvm_variant
    rgb, wide, n = [0.9, 0.5, 0.1], 0.01, 4096
    points = [[*rgb, 0], [*rgb, 0], [*rgb, 1], [*rgb, 0], [*rgb, 0]]
    peak = TransferFunction([0, 0.4 - wide, 0.4, 0.4 + wide, 1], points, 150, "emission")
    layer = coloured(mi, np.linspace(0, 1, n), peak)
    found = picture(mi, {"extinction": layer, "steps": steps, "jitter": jitter})
    through = np.exp(-150 * wide * (1 - 1 / n))  # the values are 0 to 1 from centre to centre
    expected = np.array(rgb) * (1 - through) + through * 0.5
    np.testing.assert_allclose(found, np.broadcast_to(expected, found.shape), rtol=5e-4)


def test_jitter_has_the_same_mean(llvm_variant):
    """Other numbers for each ray, of which the mean comes near; an even volume as without it."""
    mi = llvm_variant
    assert np.ptp(picture(mi, {"extinction": 0.7, "emission": 0.2, "jitter": True})) < 1e-5
    function = TransferFunction([-1, 1], [[0.2, 0.2, 0.2, 0], [1, 1, 1, 1]], extinction=2)
    wave = {"extinction": coloured(mi, np.sin(np.arange(12)), function)}
    truth = picture(mi, {**wave, "steps": 500}).mean()
    for jitter in (False, True):
        spread = picture(mi, {**wave, "steps": 24, "jitter": jitter}).std()
        assert (spread > 1e-3) == jitter
    found = picture(mi, {**wave, "steps": 24, "jitter": True}, spp=512)
    assert found.mean() == pytest.approx(truth, abs=1e-3)


@pytest.mark.parametrize("wall", [False, True])
@pytest.mark.parametrize("of", ["extinction", "emission", "light"])
def test_gradients_by_even_matter_and_the_light_behind(llvm_variant, of, wall):
    """Forward and backward: those of e (1 - exp(-σ)) / σ + exp(-σ) L by σ, e and L."""
    mi = llvm_variant
    sigma, e, light = 1.3, 0.4, 0.5
    lamp = {"type": "rectangle", "emitter": {"type": "area", "radiance": light}}
    integrator = {"extinction": sigma, "emission": e, "steps": 8}
    loaded = scene(mi, integrator, **({"wall": lamp} if wall else {}))
    through = np.exp(-sigma)
    seen = (1 - through) / sigma
    exact = {"extinction": e * (through - seen) / sigma - through * light, "emission": seen}
    name = f"integrator.{of}.value.value"
    if of == "light":
        name = "wall.emitter.radiance.value" if wall else "behind.radiance.value"

    parameters = mi.traverse(loaded)
    leaf = type(parameters[name])(parameters[name])
    dr.enable_grad(leaf)
    parameters[name] = leaf
    parameters.update()

    def mean():
        return dr.mean(mi.render(loaded, parameters, spp=1), axis=None)

    shown = mean()
    dr.forward_from(leaf)
    forward = dr.grad(shown).array[0]
    dr.clear_grad(leaf)
    dr.backward_from(mean())
    backward = np.array(dr.grad(leaf)).sum()
    np.testing.assert_allclose([forward, backward], exact.get(of, through), rtol=1e-5)


SMOOTH, THIN = [0, 5], [0, 2.3, 2.5, 2.7, 5]


@pytest.mark.parametrize(("points", "step"), [(SMOOTH, 0.02), (THIN, 0.002)])
def test_gradients_by_a_transfer_function(llvm_variant, points, step):
    """Of a picture's mean, along random changes: those of differences with the same samples.

    A thin function is one of means between values.
    """
    mi = llvm_variant
    rng = np.random.default_rng(3)
    function = TransferFunction(points, rng.uniform(0.2, 1, (len(points), 4)), 3, "emission")
    values = rng.uniform(1, 4, (4, 4, 4))
    e = rng.uniform(4, 6, (4, 4, 4, 1)).astype(np.float32)
    emission = {"type": "gridvolume", "grid": mi.VolumeGrid(e)}
    glow = {"extinction": coloured(mi, values, function), "emission": emission}
    loaded = scene(mi, {**glow, "steps": 16})
    assert loaded.integrator().uses_means == (points == THIN)
    parameters = mi.traverse(loaded)
    leaves = {}
    keys = "extinction.table", "extinction.extinction", "extinction.values.data", "emission.data"
    for name in (f"integrator.{key}" for key in keys):
        leaves[name] = type(parameters[name])(parameters[name])
        dr.enable_grad(leaves[name])
        parameters[name] = leaves[name]
    parameters.update()
    dr.backward(dr.mean(mi.render(loaded, parameters, spp=16, seed=1, seed_grad=2), axis=None))

    for name, leaf in leaves.items():
        start = np.array(leaf)
        change, means = rng.random(start.shape).astype(np.float32), []
        for by in (-step, step):
            parameters[name] = type(leaf)(start + by * change)
            parameters.update()
            means.append(float(np.array(mi.render(loaded, spp=16, seed=2), float).mean()))
        parameters[name] = type(leaf)(start)
        exact = float((np.array(dr.grad(leaf)) * change).sum())
        assert exact == pytest.approx((means[1] - means[0]) / (2 * step), rel=0.002), name


@pytest.mark.quick
def test_a_surface_in_the_volume_ends_the_ray(llvm_variant):
    """Half of the depth, and what the surface emits behind it."""
    mi = llvm_variant
    wall = mi.ScalarTransform4f().translate([0.5, 0.5, 0.5])
    lamp = {"type": "rectangle", "to_world": wall, "emitter": {"type": "area", "radiance": 2.0}}
    found = picture(mi, {"extinction": 1.5, "emission": 0.4, "steps": 4}, lamp=lamp)
    light = 0.4 * -np.expm1(-0.75) / 1.5
    np.testing.assert_allclose(found, light + 2.0 * np.exp(-0.75), rtol=1e-5)


@pytest.mark.quick
def test_a_ray_beside_the_volume_sees_what_is_behind(llvm_variant):
    mi = llvm_variant
    away = mi.ScalarTransform4f().translate([5, 0, 0])
    grid = {"type": "gridvolume", "grid": mi.VolumeGrid(np.ones((2, 2, 2, 1), np.float32))}
    found = picture(mi, {"extinction": grid | {"to_world": away}, "emission": 9.0})
    np.testing.assert_allclose(found, 0.5, rtol=1e-6)


def test_gradients_by_a_grid(llvm_variant):
    """Of the mean of a picture, along a random change of σ: those of finite differences."""
    mi = llvm_variant
    rng = np.random.default_rng(0)
    grids = rng.uniform(0.5, 2.0, (2, 4, 4, 4, 1)).astype(np.float32)
    volumes = {
        name: {"type": "gridvolume", "grid": mi.VolumeGrid(grid)}
        for name, grid in zip(("extinction", "emission"), grids, strict=True)
    }
    loaded = scene(mi, volumes | {"steps": 16})
    parameters = mi.traverse(loaded)
    name = "integrator.extinction.data"
    values, change = np.array(parameters[name]), rng.random((4, 4, 4, 1), np.float32)

    leaf = mi.TensorXf(values)
    dr.enable_grad(leaf)
    parameters[name] = leaf
    parameters.update()
    dr.backward(dr.mean(mi.render(loaded, parameters, spp=SPP), axis=None))
    exact = float((np.array(dr.grad(leaf)) * change).sum())

    means = []
    for step in (-0.01, 0.01):
        parameters[name] = mi.TensorXf(values + step * change)
        parameters.update()
        means.append(float(np.array(mi.render(loaded, spp=SPP), float).mean()))
    assert exact == pytest.approx((means[1] - means[0]) / 0.02, rel=0.005)


@pytest.mark.quick
@pytest.mark.parametrize("wrong", ["dense", [1.0, 2.0], True])
def test_what_is_no_volume_is_refused(llvm_variant, wrong):
    if not isinstance(wrong, str | bool):
        wrong = llvm_variant.ScalarVector3f(1, 2, 3)
        wrong = llvm_variant.ScalarTransform4f().translate(wrong)
    with pytest.raises(RuntimeError, match=r"extinction = .* should be a volume"):
        llvm_variant.load_dict({"type": "emission_absorption", "extinction": wrong})


@pytest.mark.parametrize("variant", ["llvm_ad_rgb", "llvm_ad_spectral"])
def test_a_bright_colour_is_not_clipped(llvm_variant, variant, request):
    """Ten times the colour gives ten times the light, also where colours become spectra."""
    mi = llvm_variant
    request.addfinalizer(lambda: mi.set_variant("llvm_ad_rgb"))
    mi.set_variant(variant)
    dim, bright = (
        picture(mi, {"emission": {"type": "rgb", "value": [k, 2 * k, 3 * k]}}, spp=SPP)
        - picture(mi, {}, spp=SPP)
        for k in (0.3, 3.0)
    )
    np.testing.assert_allclose(bright.mean((0, 1)), 10 * dim.mean((0, 1)), rtol=1e-3)
    np.testing.assert_allclose(dim.mean((0, 1)) / dim.mean(), [0.5, 1, 1.5], rtol=0.02)


@pytest.mark.quick
@pytest.mark.parametrize(
    ("name", "value", "said"),
    [
        ("extinction", float("nan"), "a gridvolume, or a number"),
        ("extinction", -1.0, "should be a number, at least 0"),
        ("emission", float("inf"), "a gridvolume, a number or a colour"),
        ("extinction", {"type": "rgb", "value": [1, 2, 3]}, "a gridvolume, or a number"),
        ("emission", {"type": "rgb", "value": [1, -2, 3]}, "a colour of finite values"),
        ("extinction", np.ones((2, 2, 2, 3)), "should be a volume of one channel"),
        ("extinction", np.full((2, 2, 2, 1), np.nan), "a volume of finite values"),
        ("emission", np.full((2, 2, 2, 3), -1.0), "a volume of finite values"),
    ],
)
def test_values_without_a_meaning_are_refused(llvm_variant, name, value, said):
    mi = llvm_variant
    if isinstance(value, np.ndarray):
        value = {"type": "gridvolume", "grid": mi.VolumeGrid(value.astype(np.float32))}
    with pytest.raises(RuntimeError, match=said):
        mi.load_dict({"type": "emission_absorption", name: value})
