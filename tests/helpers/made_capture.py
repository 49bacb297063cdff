"""Photographs of a made sample, rendered by Mitsuba, of which the maps are known."""

import numpy as np
from scipy.ndimage import gaussian_filter

import brdfkit as bk
from brdfkit.core.jit.threads import use_two_threads
from brdfkit.inverse.photographs.capture.pinhole import find_corners
from brdfkit.inverse.photographs.maps.scene import make_bsdf_dict

SIDE = 0.1  # m
CAMERA = bk.photographs.Pinhole(
    np.array([0.02, -0.05, 0.35]), np.zeros(3), np.array([0.0, 1.0, 0.0]), 22.0
)
F0 = 0.5


class Truth:
    """A sample of `texels` a side: what `make_bsdf_dict` reads of an `Svbrdf`."""

    model, fixed, size = "ggx", {"f0": F0}, (SIDE, SIDE)

    def __init__(self, texels, seed=3):
        rng = np.random.default_rng(seed)

        def pattern(width, channels=1):
            grid = rng.standard_normal((texels, texels, channels))
            smooth = gaussian_filter(grid, (width, width, 0), mode="wrap")
            return (smooth - smooth.min()) / np.ptp(smooth)

        height = pattern(4)[..., 0]
        by_row, by_column = np.gradient(0.25 * height / np.abs(np.gradient(height)[0]).max())
        normal = np.stack([-by_column, by_row, np.ones_like(height)], axis=-1)
        self.maps = {
            "diffuse_reflectance": 0.05 + 0.5 * pattern(3, 3),
            "specular_reflectance": 0.1 + 0.4 * np.repeat(pattern(5), 3, axis=2),
            "alpha_u": 0.15 * (0.4 / 0.15) ** pattern(6)[..., 0],
            "normal": normal / np.linalg.norm(normal, axis=-1, keepdims=True),
        }


def lights(count, seed=4):
    """(positions, intensities) of lights that look at the sample from all around."""
    rng = np.random.default_rng(seed)
    theta, phi = np.radians(rng.uniform(5, 60, count)), 2 * np.pi * rng.random(count)
    way = rng.uniform(0.4, 0.6, count)
    across = np.sin(theta)
    directions = np.stack([across * np.cos(phi), across * np.sin(phi), np.cos(theta)], axis=1)
    return way[:, None] * directions, np.tile([1.0, 0.9, 0.8], (count, 1))


def photograph(bsdf, position, intensity, pixels, spp=36, camera=CAMERA):
    """What a camera sees of the sample with a BSDF, under a light."""
    import mitsuba as mi

    scene = {
        "type": "scene",
        "integrator": {"type": "direct"},
        "sensor": camera.scene_dict((pixels, pixels)) | {"sampler": {"type": "multijitter"}},
        "sample": {
            "type": "rectangle",
            "to_world": mi.ScalarTransform4f().scale(SIDE / 2),
            "bsdf": bsdf,
        },
        "light": {
            "type": "point",
            "position": position.tolist(),
            "intensity": {"type": "rgb", "value": intensity.tolist()},
        },
    }
    return np.array(mi.render(mi.load_dict(scene), spp=spp), float)


def photographs(texels, count, noise=0.01, pixels=None, truth=None, lights_at=None, cameras=None):
    """(`Truth`, `Capture` with relative noise) of a made sample under so many lights."""
    truth = truth or Truth(texels)
    bsdf, places, pixels = (
        make_bsdf_dict(truth),
        lights_at or lights(count),
        pixels or round(1.4 * texels),
    )
    clean = np.array(
        [
            photograph(bsdf, *light, pixels, camera=camera)
            for *light, camera in zip(*places, cameras or [CAMERA] * count, strict=True)
        ]
    )
    noisy = clean * (1 + noise * np.random.default_rng(5).standard_normal(clean.shape))
    names = tuple(f"{k:02}.exr" for k in range(count))
    return truth, bk.photographs.Capture(noisy, *places, cameras or CAMERA, (SIDE, SIDE), names)


def write_capture(capture, folder, by_corners=False):
    """The folder of a capture: photographs, and capture.toml.

    `by_corners`: where the cameras were is said by the corners of the sample, lights are flashes.
    """
    import mitsuba as mi

    camera = capture.cameras[0]
    lines = [
        f"[sample]\nwidth = {capture.size[0]}\nheight = {capture.size[1]}\n",
        f"[camera]\norigin = {camera.origin.tolist()}\nfov = {camera.fov}\n",
    ]
    for name, picture, place, power, camera in zip(
        capture.names,
        capture.pictures,
        capture.positions,
        capture.intensities,
        capture.cameras,
        strict=True,
    ):
        with use_two_threads():
            mi.Bitmap(np.float32(picture)).write(str(folder / name))
        lines.append(f'[[light]]\npicture = "{name}"\nintensity = {power.tolist()}')
        if by_corners:
            corners = camera.project(find_corners(capture.size), capture.picture_size).tolist()
            lines.append(f'position = "camera"\ncamera = {{ corners = {corners} }}\n')
        else:
            lines.append(f"position = {place.tolist()}\n")
    (folder / "capture.toml").write_text("\n".join(lines))
