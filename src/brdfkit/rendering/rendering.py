"""Path-traced pictures of materials: the same scene, the same samples, their differences.

The first picture is the reference, as a rule the measured material. All pictures grow together,
pass by pass, so that an interrupted render still compares like with like.
"""

import io
from collections.abc import Callable, Iterable
from dataclasses import dataclass, field
from math import inf
from pathlib import Path
from typing import Any

import numpy as np

from brdfkit.errors import BrdfkitError
from brdfkit.files import write_safely
from brdfkit.names import make_unique
from brdfkit.rendering import scenes
from brdfkit.rendering.memory import require_memory
from brdfkit.rendering.montage import montage, picture_suffix, write_exr
from brdfkit.rendering.subjects import Renderable, as_list, described, load_scene, mitsuba
from brdfkit.rendering.tracing import trace
from brdfkit.threads import in_turn


@dataclass(frozen=True, eq=False)
class Rendering:
    """Pictures of one scene with several materials; the first is the reference. Made by `render`.

    Attributes
    ----------
    pictures : dict of str to ndarray, shape (height, width, 3)
        The pictures by name: float32, linear sRGB.
    spp : int
        Samples per pixel that every picture has; fewer than `asked` after Ctrl-C.
    seconds : float
        Wall-clock time.
    seed : int
        Seed of the samples.
    parameters : dict of str to dict
        The material's parameters by the picture's name, where it has any.
    mask : ndarray of bool, shape (height, width), or None
        Where the material shows; None for everywhere.
    asked : int or None
        Samples per pixel that were asked for.
    """

    pictures: dict[str, np.ndarray] = field(repr=False)
    spp: int
    seconds: float
    seed: int = 0
    parameters: dict[str, dict] = field(default_factory=dict)
    mask: np.ndarray | None = field(default=None, repr=False)
    asked: int | None = None

    @property
    def reference(self) -> str:
        """Name of the picture that the others are compared to."""
        return next(iter(self.pictures))

    @property
    def differences(self) -> dict[str, np.ndarray]:
        """Picture minus reference, (height, width, 3), by the name of every other picture."""
        first = self.pictures[self.reference]
        return {n: p - first for n, p in self.pictures.items() if n != self.reference}

    def psnr(self) -> dict[str, float]:
        """Peak signal-to-noise ratio [dB] to the reference, by the name of every other picture.

        10·log10(peak² / mean squared difference), linear values, all channels, over the pixels
        that show the ball; peak is the 99.9th percentile of the reference there. inf for
        equal pictures.

        Examples
        --------
        >>> render(["car_paint", "ward"], spp=16, size=128).psnr()    # doctest: +SKIP
        {'ward': 24.6}
        """
        mask = slice(None) if self.mask is None else self.mask
        peak = np.percentile(self.pictures[self.reference][mask], 99.9)
        errors = {n: np.square(d[mask], dtype=float).mean() for n, d in self.differences.items()}
        with np.errstate(divide="ignore"):  # a black reference: -inf
            return {n: float(10 * np.log10(peak**2 / e)) if e else inf for n, e in errors.items()}

    def write(self, path: str | Path) -> None:
        """Write the pictures to a file.

        The EXR has one named part a picture and one a difference ("difference: NAME"), each
        with R, G, B float32 and, in its header, spp, seed, brdfkit (the version) and parameters
        (JSON). A difference is picture minus reference, linear. The PNG shows the pictures side
        by side, captioned, over their differences in colour (CIEDE2000).

        Parameters
        ----------
        path : str or Path
            `.exr` for everything, with a `.png` of the same stem beside it, or `.png` alone.

        Raises
        ------
        BrdfkitError
            For another suffix, or where it cannot write; no file is half-written.

        Examples
        --------
        >>> render(["car_paint", "ward"]).write("paint.exr")    # doctest: +SKIP
        """
        path = Path(path)
        suffix = picture_suffix(path)
        png = self._repr_png_()
        if suffix == ".exr":
            with write_safely(path) as beside:
                write_exr(self, beside)
        with write_safely(path.with_suffix(".png") if suffix == ".exr" else path) as beside:
            beside.write_bytes(png)

    def _repr_png_(self) -> bytes:
        """The montage, which notebooks show."""
        stream = io.BytesIO()
        montage(self).save(stream, "PNG")
        return stream.getvalue()

    @property
    def captions(self) -> dict[str, str]:
        """A word or two on each picture, by its name."""
        figures = {name: f"PSNR {value:.1f} dB" for name, value in self.psnr().items()}
        return {self.reference: "reference" if figures else f"{self.spp} spp", **figures}

    def __str__(self) -> str:
        height, width = self.pictures[self.reference].shape[:2]
        head = f"{width}×{height} pixels, {self.spp} spp, {self.seconds:.1f} s"
        return "\n".join([head, *(f"  {name}: {said}" for name, said in self.captions.items())])


def render(
    things: Renderable | Iterable[Renderable],
    spp: int = 256,
    size: int | tuple[int, int] = 512,
    seed: int = 0,
    scene: Callable[[dict[str, Any], tuple[int, int]], dict[str, Any]] | None = None,
    progress: Callable[[int, int], object] | None = None,
) -> Rendering:
    """Path-trace one or several materials in the same scene, with the same samples.

    It runs in the current variant of Mitsuba; where none is set, in the best that works. Ctrl-C
    keeps the passes that every picture has; before the first of them it is raised. Renders of
    several threads run one after the other.

    Parameters
    ----------
    things : Measured, Fit, Model, str, Path, dict or (str, one of these), or several
        The materials, the reference first: objects, names or paths, BSDFs' dictionaries, which may
        hold a "name", or pairs of a name and one of these.
    spp : int, default 256
        Samples per pixel.
    size : int or (int, int), default 512
        Side, or width and height, of a picture [pixels].
    seed : int, default 0
        Seed of the samples; equal seeds give equal pictures, up to the order in which threads sum
        up (1e-6).
    scene : callable, optional
        Gives the scene's dictionary for (BSDF's dictionary, (width, height)). By default
        `brdfkit.rendering.scenes.ball`: a ball on grey ground under a clear sky and one softbox.
    progress : callable, optional
        Called with (done, total) after each pass of a picture.

    Returns
    -------
    Rendering
        The pictures; ``write`` makes an OpenEXR file of all, or a PNG to look at.

    Raises
    ------
    BrdfkitError
        For what cannot be rendered, and for pictures larger than the memory that is available.

    Examples
    --------
    >>> pictures = render(["car_paint", ("grey", {"type": "diffuse"})], spp=16)    # doctest: +SKIP
    >>> pictures.write("paint.exr")    # doctest: +SKIP
    """
    width, height = (size, size) if isinstance(size, int | np.integer) else size
    size = width, height
    if min(size) < 1:
        raise BrdfkitError(f"{size} pixels make no picture; give a size above 0.")
    subjects = as_list(things)
    require_memory(size, len(subjects))
    mitsuba()  # in a variant: dictionaries depend on it
    materials: dict[str, dict[str, Any]] = {}
    parameters: dict[str, dict[str, Any]] = {}
    for thing in subjects:
        name, bsdf, values = described(thing)
        name = make_unique(name, materials)
        materials[name] = bsdf
        if values:
            parameters[name] = values
    build, mask = (scene, None) if scene else (scenes.ball, scenes.ball_mask(size))
    scenes_by_name = {name: build(bsdf, size) for name, bsdf in materials.items()}
    pictures, reached, seconds = _traced(scenes_by_name, spp, seed, progress)
    return Rendering(pictures, reached, seconds, seed, parameters, mask, asked=spp)


@in_turn
def render_scene(
    path: str | Path,
    spp: int | None = None,
    seed: int = 0,
    progress: Callable[[int, int], object] | None = None,
) -> Rendering:
    """Path-trace a scene file of Mitsuba's, in which brdfkit's plugins may appear.

    Size, camera and integrator are the scene's. For Ctrl-C, threads and variants see `render`.

    Parameters
    ----------
    path : str or Path
        The file, `.xml`.
    spp : int, optional
        Samples per pixel; by default those of the scene's sampler.
    seed : int, default 0
        Seed of the samples.
    progress : callable, optional
        Called with (done, total) after each pass.

    Returns
    -------
    Rendering
        One picture.

    Raises
    ------
    BrdfkitError
        For a file that is missing or that Mitsuba cannot load, for a scene without a sensor or an
        integrator, and for a picture larger than the memory that is available.

    Examples
    --------
    >>> render_scene("kitchen.xml", spp=64).write("kitchen.exr")    # doctest: +SKIP
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
