"""Photographs of a made ball under known lights, written as every kind of folder that is read."""

from dataclasses import dataclass, field

import numpy as np
from PIL import Image

PIXELS, RADIUS = 48, 20
ALBEDO = np.array([0.8, 0.6, 0.4])


def directions(count=12, seed=1):
    """Unit vectors (count, 3) to lights all around, at most 55° from the camera."""
    rng = np.random.default_rng(seed)
    theta = np.radians(rng.uniform(10, 55, count))
    phi = 2 * np.pi * (np.arange(count) + rng.random(count)) / count
    across = np.sin(theta)
    return np.stack([across * np.cos(phi), across * np.sin(phi), np.cos(theta)], axis=1)


def ball():
    """The mask (height, width) and normals (height, width, 3) of a ball, not in the middle."""
    rows, columns = np.indices((PIXELS, PIXELS))
    x, y = (columns - 22) / RADIUS, (25 - rows) / RADIUS
    mask = x**2 + y**2 < 1
    z = np.sqrt(np.maximum(1 - x**2 - y**2, 0))
    return mask, np.stack([x, y, z], axis=-1) * mask[..., None]


def shade(lights, strengths=1.0, power=1.0, texture=0.3):
    """Photographs (lights, height, width, 3) of a matte ball with stripes, to a `power`."""
    mask, normals = ball()
    cosine = np.maximum(np.einsum("hwc,kc->khw", normals, lights), 0) * mask
    stripes = 1 - texture + texture * np.sin(np.arange(PIXELS) / 3)[:, None]
    strengths = np.broadcast_to(strengths, len(lights))[:, None, None]
    return ((cosine * stripes * strengths)[..., None] * ALBEDO) ** power


def mirror(lights):
    """Photographs of a chrome ball, in which each light is a spot of a few pixels."""
    mask, normals = ball()
    mirrored = 2 * normals[..., 2:] * normals - [0, 0, 1]
    cosine = np.einsum("hwc,kc->khw", mirrored, lights)
    return np.repeat((np.exp((cosine - 1) * 5) * mask)[..., None], 3, axis=3)


def write_png(path, values, bits=16):
    """Write values (height, width, 3) from 0 to 1 as a PNG of 8 or 16 bits."""
    import mitsuba as mi

    kind = {8: np.uint8, 16: np.uint16}[bits]
    path.parent.mkdir(exist_ok=True, parents=True)
    whole = np.round(np.clip(values, 0, 1) * (2**bits - 1)).astype(kind)
    mi.Bitmap(np.ascontiguousarray(whole)).write(str(path))


def write_mask(path, mask=None):
    path.parent.mkdir(exist_ok=True, parents=True)
    Image.fromarray((ball()[0] if mask is None else mask).astype(np.uint8) * 255).save(path)


def rows(values):
    return "\n".join(" ".join(f"{number:.8f}" for number in row) for row in values) + "\n"


@dataclass
class Made:
    """A ball under `lights`, as written to a folder; a test changes what it likes before."""

    lights: np.ndarray = field(default_factory=directions)
    strengths: object = 1.0
    power: float = 1.0
    bits: int = 16
    stated: np.ndarray | None = None  # directions in files, where they are not the true ones
    mask: bool = True
    texture: float = 0.3

    @property
    def names(self):
        return [f"ball_{k}.png" for k in range(len(self.lights))]  # 10 comes after 9

    def write_photographs(self, folder, pictures=None):
        if pictures is None:
            pictures = shade(self.lights, self.strengths, self.power, self.texture)
        for name, picture in zip(self.names, pictures, strict=True):
            write_png(folder / name, picture, self.bits)
        if self.mask:
            write_mask(folder / "mask.png")

    @property
    def vectors(self):
        return self.lights if self.stated is None else self.stated

    def diligent(self, folder):
        self.write_photographs(folder)
        strengths = np.broadcast_to(self.strengths, len(self.lights))[:, None]
        (folder / "filenames.txt").write_text("\n".join(self.names))
        (folder / "light_directions.txt").write_text(rows(self.vectors))
        (folder / "light_intensities.txt").write_text(rows(strengths * np.ones(3)))
        return folder

    def series(self, folder):
        self.write_photographs(folder)
        lines = [str(len(self.names)), *self.names, "mask.png"]
        (folder / f"{folder.name}.txt").write_text("\n".join(lines))
        (folder.parent / "lights.txt").write_text(f"{len(self.names)}\n{rows(self.vectors)}")
        return folder

    def series_beside_chrome(self, folder):
        chrome = folder.parent / "chrome"
        self.series(folder)
        (folder.parent / "lights.txt").unlink()
        Made(self.lights).write_photographs(chrome, mirror(self.lights))
        lines = [str(len(self.names)), *self.names, "mask.png"]
        (chrome / "chrome.txt").write_text("\n".join(lines))
        return folder

    def psbox(self, folder):
        self.write_photographs(folder / "Objects")
        (folder / "light_directions.txt").write_text(rows(self.vectors.T))
        return folder

    def probes(self, folder):
        self.psbox(folder)
        (folder / "light_directions.txt").unlink()
        probe = folder / "LightProbe-1"
        Made(self.lights, mask=False).write_photographs(probe, mirror(self.lights))
        (probe / "circle_data.txt").write_text(f"{22 + 1}\n{PIXELS - 25}\n{RADIUS}\n")
        return folder

    def rti(self, folder):
        self.write_photographs(folder)
        lines = [
            f"C:\\scan 1\\{name} {x} {y} {z}"
            for name, (x, y, z) in zip(self.names, self.vectors, strict=True)
        ]
        (folder / "ball.lp").write_text(f"{len(lines)}\n" + "\n".join(lines))
        return folder

    def table(self, folder):
        self.write_photographs(folder)
        (folder / "light_directions.csv").write_text(
            "x;y;z\n" + rows(self.vectors).replace(" ", ";")
        )
        return folder

    def turned_table(self, folder):
        self.write_photographs(folder)
        (folder / "lights.txt").write_text("# x, y, z\n" + rows(self.vectors.T))
        return folder

    def named_table(self, folder):
        self.write_photographs(folder)
        order = np.arange(len(self.names))[::-1]
        lines = [f"{self.names[k]}, {', '.join(map(str, self.vectors[k]))}, 1" for k in order]
        (folder / "lights.csv").write_text("picture,x,y,z,strength\n" + "\n".join(lines))
        return folder

    def toml(self, folder):
        self.write_photographs(folder)
        lights = [
            f'[[light]]\npicture = "{name}"\ndirection = {list(map(float, vector))}'
            for name, vector in zip(self.names, self.vectors, strict=True)
        ]
        (folder / "capture.toml").write_text("[object]\n" + "\n".join(lights))
        return folder
