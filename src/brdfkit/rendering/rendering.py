"""Path-traced pictures of materials: the same scene, the same samples, their differences.

The first picture is the reference, as a rule the measured material. All pictures grow together,
pass by pass, so that an interrupted render still compares like with like.
"""

import io
from collections.abc import Callable
from dataclasses import dataclass, field
from math import inf
from pathlib import Path

import numpy as np

from brdfkit.errors import BrdfkitError
from brdfkit.files import written
from brdfkit.names import unused
from brdfkit.rendering import scenes
from brdfkit.rendering.memory import require_memory
from brdfkit.rendering.montage import montage, picture_suffix, write_exr
from brdfkit.rendering.subjects import described, is_pair, load_scene, mitsuba
from brdfkit.rendering.tracing import trace
from brdfkit.threads import in_turn


@dataclass(frozen=True, eq=False)
class Rendering:
    """Pictures of one scene with several materials; the first is the reference.

    `pictures`: name → (height, width, 3) float32, linear sRGB; `spp`: samples per pixel that
    every picture has, fewer than asked for after Ctrl-C; `seconds`: wall-clock time; `seed`: of
    the samples; `parameters`: name → the material's parameters, where it has any; `mask`:
    (height, width), True where the material shows, None for everywhere; `asked`: samples per pixel
    that were asked for.

    >>> render([paint, fit]).write("copper.exr")
    """

    pictures: dict[str, np.ndarray] = field(repr=False)
    spp: int
    seconds: float
    seed: int = 0
    parameters: dict[str, dict] = field(default_factory=dict)
    mask: np.ndarray | None = field(default=None, repr=False)
    asked: int | None = None

    @property
    def reference(self):
        """Name of the picture that the others are compared to."""
        return next(iter(self.pictures))

    @property
    def differences(self):
        """Name → picture minus reference, (height, width, 3), of every other picture."""
        first = self.pictures[self.reference]
        return {n: p - first for n, p in self.pictures.items() if n != self.reference}

    def psnr(self):
        """Name → peak signal-to-noise ratio [dB] to the reference, of every other picture.

        10·log10(peak² / mean squared difference), linear values, all channels, over the pixels
        that show the ball; peak is the 99.9th percentile of the reference there. inf for
        equal pictures.
        """
        mask = slice(None) if self.mask is None else self.mask
        peak = np.percentile(self.pictures[self.reference][mask], 99.9)
        errors = {n: np.square(d[mask], dtype=float).mean() for n, d in self.differences.items()}
        with np.errstate(divide="ignore"):  # a black reference: -inf
            return {n: float(10 * np.log10(peak**2 / e)) if e else inf for n, e in errors.items()}

    def write(self, path):
        """Write `path`: .exr for everything, with a .png of the same stem beside it, or .png.

        The EXR has one named part a picture and one a difference ("difference: NAME"), each
        with R, G, B float32 and, in its header, spp, seed, brdfkit (the version) and parameters
        (JSON). A difference is picture minus reference, linear. The PNG shows the pictures side
        by side, captioned, over their differences in colour (CIEDE2000).
        Raises `BrdfkitError` for another suffix or where it cannot write; no half-written file.
        """
        path = Path(path)
        suffix = picture_suffix(path)
        png = self._repr_png_()
        if suffix == ".exr":
            with written(path) as beside:
                write_exr(self, beside)
        with written(path.with_suffix(".png") if suffix == ".exr" else path) as beside:
            beside.write_bytes(png)

    def _repr_png_(self):
        """The montage, which notebooks show."""
        stream = io.BytesIO()
        montage(self).save(stream, "PNG")
        return stream.getvalue()

    @property
    def captions(self):
        """Name → what there is to say of the picture in a word or two."""
        figures = {name: f"PSNR {value:.1f} dB" for name, value in self.psnr().items()}
        return {self.reference: "reference" if figures else f"{self.spp} spp", **figures}

    def __str__(self):
        height, width = self.pictures[self.reference].shape[:2]
        head = f"{width}×{height} pixels, {self.spp} spp, {self.seconds:.1f} s"
        return "\n".join([head, *(f"  {name}: {said}" for name, said in self.captions.items())])


def render(
    things,
    spp: int = 256,
    size: int | tuple[int, int] = 512,
    seed: int = 0,
    scene: Callable | None = None,
    progress: Callable[[int, int], None] | None = None,
) -> Rendering:
    """Path-trace one or several materials in the same scene, with the same samples.

    `things`: a material or a list of them, the reference first: anything with `.scene_dict()`
    and `.name` (measured, fit, model), a BSDF's dictionary, with a key "name" or not, or a pair
    (name, one of those). `spp`: samples per pixel; `size`: side or (width, height) [pixels];
    `scene`: a function (bsdf, size) → scene dictionary in place of `brdfkit.scenes.ball`;
    `progress`: called with (done, total) after each pass of a picture.

    Equal seeds give equal pictures, up to the order in which threads sum up (1e-6). Ctrl-C
    keeps the passes that every picture has; before the first of them it is raised.
    Raises `BrdfkitError` for what cannot be rendered, and for pictures larger than the memory that
    is available. Uses the current variant of Mitsuba, where none is set the best that works.
    It may be called from any thread; renders of several threads run one after the other.

    >>> render([paint, ("grey", {"type": "diffuse"})], spp=16, size=128).psnr()
    """
    size = (size, size) if np.ndim(size) == 0 else tuple(size)
    if min(size) < 1:
        raise BrdfkitError(f"{size} pixels make no picture; give a size above 0.")
    if is_pair(things) or isinstance(things, dict | str) or not hasattr(things, "__iter__"):
        things = [things]
    things = list(things)
    if not things:
        raise BrdfkitError("There is nothing to render; give at least one material.")
    require_memory(size, len(things))
    mitsuba()  # in a variant: dictionaries depend on it
    materials, parameters = {}, {}
    for thing in things:
        name, bsdf, values = described(thing)
        name = unused(name, materials)
        materials[name] = bsdf
        if values:
            parameters[name] = values
    build, mask = (scene, None) if scene else (scenes.ball, scenes.ball_mask(size))
    scenes_by_name = {name: build(bsdf, size) for name, bsdf in materials.items()}
    pictures, reached, seconds = _traced(scenes_by_name, spp, seed, progress)
    return Rendering(pictures, reached, seconds, seed, parameters, mask, asked=spp)


@in_turn
def render_scene(path, spp: int | None = None, seed: int = 0, progress=None) -> Rendering:
    """Path-trace a Mitsuba scene file, `path`.xml, in which brdfkit's models may appear.

    `spp`: samples per pixel, by default those of the scene's sampler. Size, camera and integrator
    are the scene's; the rest is as in `render`.

    >>> render_scene("kitchen.xml", spp=64).write("kitchen.exr")
    """
    path = Path(path)
    if not path.is_file():
        raise BrdfkitError(f"{path}: there is no such scene file; check the path.")
    scene = load_scene(mitsuba().load_file, str(path), path)
    if not scene.sensors():
        raise BrdfkitError(f"{path}: the scene has no sensor to see it with; add a <sensor>.")
    if scene.integrator() is None:
        raise BrdfkitError(f'{path}: the scene has no integrator; add <integrator type="path"/>.')
    require_memory(scene.sensors()[0].film().size(), 1, path)
    if spp is None:
        spp = scene.sensors()[0].sampler().sample_count()
    pictures, reached, seconds = trace({path.stem: scene}, spp, seed, progress)
    return Rendering(pictures, reached, seconds, seed, asked=spp)


@in_turn
def _traced(dictionaries, spp, seed, progress):
    """What `trace` makes of scene dictionaries, name → dictionary.

    The scenes end here, too: Mitsuba traces through the BSDFs of all that there are in the process.
    """
    loaded = {name: load_scene(mitsuba().load_dict, d, name) for name, d in dictionaries.items()}
    return trace(loaded, spp, seed, progress)
