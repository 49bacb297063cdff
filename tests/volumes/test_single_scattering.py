"""Single scattering: closed forms, quadrature, Mitsuba's `volpath`, derivatives, wrong bounds."""

import math

import drjit as dr
import numpy as np
import pytest
from brdfkit.theses.lesar2018.volpath_settings import compute_z_scores, make_settings, render_passes

from brdfkit import BrdfkitError
from brdfkit.volumes import TransferFunction

DEVIATIONS = 4.5  # of a mean: one in 150 000 is farther
SIZE = 32  # pixels along the edges of a picture
# σ, α, g, depth of a slab, the cosine between the sun's rays and the camera's, the radiance seen
SLABS = [
    (1, 0.8, 0.6, 2, -1, 0.172314),
    (1, 0.8, 0.6, 2, 1, 0.004882),
    (2, 0.5, -0.3, 1, 0.5, 0.017146),
    (2, 0.5, -0.3, 1, -0.5, 0.002585),
    (0.5, 1, 0, 4, 0.7071, 0.032698),
    (400, 0.8, 0, 1, 0.7071, 0.8 / (4 * math.pi) / (1 + 1 / 0.7071)),
]


def slab(mi, extinction, depth=1.0, others=None, **integrator):
    """A scene of a slab, as good as endless across, seen from the front along z.

    extinction : number, the values (n,) of voxels behind each other, or a volume.
    """
    to_world = mi.ScalarTransform4f().scale([1000, 1000, depth]).translate([-0.5, -0.5, 0])
    camera = mi.ScalarTransform4f().look_at([0, 0, -1], [0, 0, 0], [0, 1, 0]).scale(1e-3)
    film = {"type": "hdrfilm", "width": SIZE, "height": SIZE, "rfilter": {"type": "box"}}
    film["pixel_format"] = "luminance"
    if not isinstance(extinction, dict):
        extinction = voxels(mi, extinction)
    grid = extinction.get("values", extinction)
    grid["to_world"] = to_world
    return mi.load_dict(
        {
            "type": "scene",
            "integrator": {"type": "single_scattering", "extinction": extinction, **integrator},
            "sensor": {"type": "orthographic", "to_world": camera, "film": film},
            **(others or {}),
        }
    )


def voxels(mi, values):
    """A gridvolume of the values (n,) along z."""
    values = np.asarray(values, np.float32).reshape(-1, 1, 1, 1)
    return {"type": "gridvolume", "grid": mi.VolumeGrid(values), "raw": True}


def sun(cosine):
    direction = [math.sqrt(1 - cosine**2), 0, cosine]
    return {"sun": {"type": "directional", "direction": direction, "irradiance": 1.0}}


def sky(radiance):
    return {"sky": {"type": "constant", "radiance": radiance}}


def hg(g):
    return {"type": "hg", "g": g}


def require_mean(found, expected, rounding=0.0):
    """The mean of independent numbers is what it should be, within its error."""
    found = np.array(found, float).ravel()
    error = found.std(ddof=1) / math.sqrt(len(found))
    assert abs(found.mean() - expected) < DEVIATIONS * error + rounding


def radiance(z, sigma, albedo, g, cosine):
    """Of a slab in the sun, by quadrature of σ (n,) at the even depths z."""
    mu, step = -cosine, z[1] - z[0]
    phase = (1 - g**2) / (4 * math.pi * (1 + g**2 - 2 * g * mu) ** 1.5)
    before = np.cumsum(sigma) * step - sigma * step / 2
    to_sun = before if cosine > 0 else sigma.sum() * step - before
    light = np.exp(-before - to_sun / abs(cosine))
    return albedo * phase * np.sum(sigma * light) * step


# What is known in closed form


@pytest.mark.parametrize(("sigma", "albedo", "g", "depth", "cosine", "known"), SLABS)
def test_a_slab_in_the_sun(sigma, albedo, g, depth, cosine, known, llvm_variant):
    mi = llvm_variant
    scene = slab(mi, sigma, depth, sun(cosine), albedo=albedo, phase=hg(g))
    require_mean(mi.render(scene, spp=64), known, 5e-7)
    z = (np.arange(200_000) + 0.5) / 200_000 * depth
    assert radiance(z, 0 * z + sigma, albedo, g, cosine) == pytest.approx(known, abs=1e-6)


@pytest.mark.parametrize("max_depth", [1, 2, 4])
def test_without_scattering_the_background_is_seen_through(max_depth, llvm_variant):
    mi = llvm_variant
    scene = slab(mi, [0.5, 3.0, 1.0], 0.8, sky(0.7), albedo=0.0, max_depth=max_depth)
    z = (np.arange(1000) + 0.5) / 1000 * 3 - 0.5
    depth = 0.8 * np.interp(z, [0, 1, 2], [0.5, 3.0, 1.0]).mean()
    require_mean(mi.render(scene, spp=16), 0.7 * math.exp(-depth))


def test_the_error_falls_with_the_root_of_the_samples(llvm_variant):
    mi, numbers = llvm_variant, [4, 16, 64, 256]
    scene = slab(mi, 1.0, 2, sun(-1), albedo=0.8, phase=hg(0.6))
    errors = [np.std(np.array(mi.render(scene, spp=n)) - SLABS[0][-1]) for n in numbers]
    slope = np.polyfit(np.log(numbers), np.log(errors), 1)[0]
    assert slope == pytest.approx(-0.5, abs=0.03)


@pytest.mark.parametrize("max_depth", [1, 2])
def test_light_of_the_medium_itself(max_depth, llvm_variant):
    """By the emission, and by a transfer function; what nothing scatters goes straight."""
    mi, seen = llvm_variant, -math.expm1(-1.5)
    glow = TransferFunction([0, 2], [[0.4, 0.4, 0.4, 0.5]] * 2, 3, "emission")
    volume = {"type": "transfer_function", "values": voxels(mi, [1]), "transfer": glow.to_json()}
    dark = {"albedo": 0.0, "max_depth": max_depth}
    scene = slab(mi, volume, emission=0.6, **dark)
    require_mean(mi.render(scene, spp=64), 0.4 * seen + 0.6 * seen / 1.5)
    nothing = slab(mi, 0.0, emission=0.6, **dark)
    np.testing.assert_allclose(mi.render(nothing, spp=4), 0.6, rtol=1e-5)


def test_a_lamp_beside_the_medium(llvm_variant):
    """A sphere that is near, by quadrature over the ray and the sphere's cone."""
    mi, sigma, albedo, emitted = llvm_variant, 0.75, 0.8, 6.0
    centre, r = np.array([1.4, 1.2, 1.0]), 0.3
    eye, target = np.array([1.9, 1.1, 2.2]), np.array([0.9, 0.85, 0.85])
    film = {"type": "hdrfilm", "width": 1, "height": 1, "rfilter": {"type": "box"}}
    camera = mi.ScalarTransform4f().look_at(eye.tolist(), target.tolist(), [0, 1, 0]).scale(1e-4)
    lamp = {"type": "area", "radiance": emitted}
    scene = mi.load_dict(
        {
            "type": "scene",
            "integrator": {"type": "single_scattering", "extinction": sigma, "albedo": albedo},
            "sensor": {"type": "orthographic", "to_world": camera, "film": film},
            "lamp": {"type": "sphere", "center": centre.tolist(), "radius": r, "emitter": lamp},
        }
    )
    found = [np.array(mi.render(scene, spp=1 << 14, seed=k))[0, 0, 0] for k in range(16)]

    # The ray in the unit cube, and directions over the cone of the sphere from its points
    d = (target - eye) / np.linalg.norm(target - eye)
    near, far = within_cube(eye, d)
    s = near + (np.arange(100) + 0.5) / 100 * (far - near)
    x = (eye + s[:, None] * d)[:, None, None]
    axis = centre - x
    distance = np.linalg.norm(axis, axis=-1, keepdims=True)
    axis = axis / distance
    cone = 1 - np.sqrt(1 - (r / distance) ** 2)
    cos = 1 - (np.arange(24).reshape(-1, 1, 1) + 0.5) / 24 * cone
    phi = (np.arange(48).reshape(-1, 1) + 0.5) / 48 * 2 * np.pi
    across = np.cross(axis, [0, 0, 1])
    across /= np.linalg.norm(across, axis=-1, keepdims=True)
    round_axis = np.cos(phi) * across + np.sin(phi) * np.cross(axis, across)
    towards = cos * axis + np.sqrt(1 - cos**2) * round_axis
    _, out = within_cube(x, towards)
    light = np.exp(-sigma * out).mean(axis=(1, 2)) * (emitted * 2 * np.pi * cone.ravel())
    per_length = sigma * albedo / (4 * np.pi) * np.exp(-sigma * (s - near)) * light
    require_mean(found, per_length.mean() * (far - near), 1e-4 * np.mean(found))


def within_cube(o, d):
    """Where rays enter and leave the unit cube."""
    a, b = -o / d, (1 - o) / d
    return np.minimum(a, b).max(axis=-1), np.maximum(a, b).min(axis=-1)


# What Mitsuba's volpath finds


THREE = "grid, sky by blocks", "transfer function, surfaces", "scattered five times"


@pytest.mark.parametrize("name", THREE)
def test_the_light_is_that_of_volpath(name, llvm_variant):
    """Three of ten settings."""
    scene = make_settings()[name]
    kinds = enumerate(("single_scattering", "volpath"))
    both = [render_passes(scene, kind, spp=4, first=16 * i)[0] for i, kind in kinds]
    assert np.abs(compute_z_scores(*both)).max() < DEVIATIONS


# Derivatives


def gradients(mi, scene, names, passes=16, spp=8):
    """Of a picture's mean by parameters: name → (passes, n)."""
    parameters = mi.traverse(scene)
    leaves = {}
    for name in names:
        leaves[name] = type(parameters[name])(dr.detach(parameters[name]))
        dr.enable_grad(leaves[name])
        parameters[name] = leaves[name]
    parameters.update()
    found = {name: [] for name in names}
    for seed in range(passes):
        image = mi.render(scene, parameters, spp=spp, seed=seed, seed_grad=seed + passes)
        dr.backward(dr.mean(image, axis=None))
        for name, leaf in leaves.items():
            found[name].append(np.array(dr.grad(leaf)).ravel())
            dr.clear_grad(leaf)
    return {name: np.array(values) for name, values in found.items()}


def test_derivatives_are_those_of_the_closed_form(llvm_variant):
    """By g, α, and σ."""
    mi, known = llvm_variant, SLABS[0][-1]
    scene = slab(mi, 1.0, 2, sun(-1), albedo=0.8, phase=hg(0.6))
    expected = {
        "integrator.phase.g": 0.96927,
        "integrator.albedo.value.value": known / 0.8,
        "integrator.scale": known * (1 - 2),
        "integrator.extinction.data": known * (1 - 2),
    }
    for name, found in gradients(mi, scene, expected).items():
        require_mean(found.sum(axis=1), expected[name], 1e-5)


def test_derivatives_by_lamps_of_which_one_is_dark(llvm_variant):
    """A sample of the dark one is rare, and counts for more."""
    mi, (sigma, albedo, g, depth, cosine, known) = llvm_variant, SLABS[0]
    lamps = {"dark": {**sun(cosine)["sun"], "irradiance": 0.0}, **sun(SLABS[1][4])}
    scene = slab(mi, sigma, depth, lamps, albedo=albedo, phase=hg(g))
    expected = {"dark.irradiance.value": known, "sun.irradiance.value": SLABS[1][-1]}
    for name, found in gradients(mi, scene, expected).items():
        require_mean(found.sum(axis=1), expected[name], 1e-6)


def test_derivatives_by_voxels_and_by_a_transfer_function(llvm_variant):
    """Differences of a quadrature, by each voxel and by points of the function."""
    mi, depth, n, cosine = llvm_variant, 1.5, 3, -0.6
    values, heights = np.array([0.3, 1.6, 0.9]), np.array([0.1, 1.0, 0.4])
    z = (np.arange(3000) + 0.5) / 3000 * depth

    def light(values, heights):
        v = np.interp(z / depth * n - 0.5, np.arange(n), values)
        return radiance(z, 2 * np.interp(v, np.arange(n), heights), 0.7, 0.4, cosine)

    function = TransferFunction(np.arange(n), np.c_[np.full((n, 3), 0.7), heights], 2)
    volume = {"type": "transfer_function", "values": voxels(mi, values)}
    scene = slab(mi, volume | {"transfer": function.to_json()}, depth, sun(cosine), phase=hg(0.4))
    table, data = "integrator.extinction.table", "integrator.extinction.values.data"
    found = gradients(mi, scene, [table, data])
    rows = found[table].reshape(len(found[table]), -1, 4)[..., 3]
    hats = [np.interp(np.linspace(0, n - 1, rows.shape[1]), np.arange(n), hat) for hat in np.eye(n)]
    for k, change in enumerate(np.eye(n) * 1e-4):
        by_value = light(values + change, heights) - light(values - change, heights)
        require_mean(found[data][:, k], by_value / 2e-4, 1e-6)
        by_height = light(values, heights + change) - light(values, heights - change)
        require_mean(rows @ hats[k], by_height / 2e-4, 1e-6)


def test_a_white_cloud_in_even_light_is_not_seen(llvm_variant):
    """Long paths carry its light: none may be left to a few that stand for thousands."""
    mi = llvm_variant
    integrator = {"type": "single_scattering", "extinction": 30.0, "max_depth": 5000}
    camera = mi.ScalarTransform4f().look_at([0.5, 0.5, -3], [0.5, 0.5, 0.5], [0, 1, 0])
    film = {"type": "hdrfilm", "width": 8, "height": 8}
    scene = {
        "type": "scene",
        "integrator": integrator,
        "sensor": {"type": "perspective", "fov": 15, "to_world": camera, "film": film},
        "sky": {"type": "constant"},
    }
    means = [np.mean(mi.render(mi.load_dict(scene), spp=256, seed=k)) for k in range(4)]
    assert np.sqrt(np.mean(np.subtract(means, 1) ** 2)) < 0.016  # usually 0.005


# Majorants


def test_majorants_follow_the_parameters(llvm_variant):
    """Of a changed grid the picture is that of a new scene."""
    mi, name = llvm_variant, "integrator.extinction.data"
    old, new = (slab(mi, v, 1, sun(-0.5)) for v in ([1.0, 0.2], [9.0, 4.0]))
    mi.render(old, spp=4, seed=2)
    parameters = mi.traverse(old)
    parameters[name] = mi.traverse(new)[name]
    parameters.update()
    picture = mi.render(new, spp=4, seed=2)
    np.testing.assert_array_equal(mi.render(old, spp=4, seed=2), picture)
    parameters[name] = parameters[name] - 5  # of one voxel -1
    with pytest.raises(BrdfkitError, match="clip it at 0, for example after each step"):
        parameters.update()


def test_an_extinction_above_its_majorant_is_an_error(llvm_variant):
    """Of a volume that says less than it is; what random points miss spoils pixels, visibly."""
    mi = llvm_variant

    class Liar(mi.Volume):
        def __init__(self, radius):
            super().__init__(mi.Properties())
            self.radius = radius

        def eval_1(self, it, active=True):
            return dr.select(dr.norm(it.p - mi.Point3f(0.5, 0.5, 0)) < self.radius, 3.0, 1.0)

        def max(self):
            return 2.5

        def to_string(self):
            return "Liar[]"

    def picture(radius):
        integrator = {"type": "single_scattering", "extinction": Liar(radius)}
        camera = mi.ScalarTransform4f().look_at([0.5, 0.5, -1], [0.5, 0.5, 0], [0, 1, 0])
        film = {"type": "hdrfilm", "width": 8, "height": 8}
        sensor = {"type": "perspective", "fov": 0.5, "to_world": camera, "film": film}
        scene = {"type": "scene", "integrator": integrator, "sensor": sensor}
        return np.array(mi.render(mi.load_dict(scene), spp=64))

    with pytest.raises(RuntimeError, match=r"its majorant 2\.5: no bound"):
        picture(0.2)
    assert np.isnan(picture(0.01)).any()
