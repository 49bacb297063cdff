"""`render_volume`: a picture of CT, MRI, microscopy or simulation data in light."""

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from brdfkit import volumes
from brdfkit.core.arguments import to_number, to_positive, to_whole_number
from brdfkit.core.errors import BrdfkitError, no_such
from brdfkit.core.jit.threads import in_turn
from brdfkit.core.memory import require_memory
from brdfkit.mitsuba_bridge.properties.picture_file import load_by_mitsuba
from brdfkit.rendering.render_materials import rendering_of, to_size
from brdfkit.rendering.result import Rendering
from brdfkit.rendering.scene_input.arguments import mitsuba
from brdfkit.rendering.tracing import trace
from brdfkit.rendering.volumes import looks
from brdfkit.rendering.volumes.scene import RENDERERS, UNLIT, scene
from brdfkit.volumes import TransferFunction, Volume
from brdfkit.volumes.transfer.windows import fitted

SPP, UNLIT_SPP = 64, 8  # samples per pixel
MOST = 16_384  # of them, where a noise floor or a time is asked for
PASS = 4  # of them, so that the first picture is there soon
BACKGROUND = 0.02


def render_volume(
    volume: Volume | str | Path,
    transfer: TransferFunction | str | Path | None = None,
    renderer: str = "single_scattering",
    spp: int | None = None,
    size: int | tuple[int, int] = 512,
    seed: int = 0,
    progress: Callable[..., object] | None = None,
    until: float | None = None,
    seconds: float | None = None,
    envmap: str | Path = "studio",
    background: float | tuple[float, float, float] | None = BACKGROUND,
    azimuth: float = 30.0,
    elevation: float = 20.0,
    density: float = 1.0,
    all_around: bool = False,
    **settings: Any,
) -> Rendering:
    """Render a volume: CT, MRI, microscopy or simulation data in the light of an environment.

    The camera sees the whole box, the head of patients up. It runs in the current variant of
    Mitsuba; where none is set, in the best that works. Ctrl-C keeps the passes that are done.

    Parameters
    ----------
    volume : Volume, str or Path
        The volume; or the file, folder or name that `volumes.load` takes.
    transfer : TransferFunction, str or Path, optional
        What its values look like: colours and extinction; or the name of a preset, or a file. By
        default a colour for each label; of scans in HU "ct_bone", or "ct_skin" without bone; of
        others of patients "mri_head" over the volume's `window`; else a colour map over it.
    renderer : str, default "single_scattering"
        "single_scattering": light of the environment, scattered once; "emission_absorption": what
        glows and dims; "maximum_intensity": the largest value along each ray; "isosurface": the
        surface of one value, in light.
    spp : int, optional
        Samples per pixel, by default 64, and 8 of what has no light but its own, where they leave
        no noise that is seen; with `until` or `seconds` the most of them, by default 16,384.
    size : int or (int, int), default 512
        Side, or width and height, of the picture [pixels].
    seed : int, default 0
        Seed of the samples.
    progress : callable, optional
        Called with (done, total) after each pass; see `brdfkit.progress`. One with a parameter
        `pictures` also gets a function: ``pictures()[volume.name]`` is the picture so far.
    until : float, optional
        Adds samples until the noise floor, the PSNR of the picture to itself with another seed, is
        so high [dB, above 0]; 45 leaves noise that is hardly seen.
    seconds : float, optional
        Adds samples for so long [s, above 0]; there is one pass at least.
    envmap : str or Path, default "studio"
        The environment map of single_scattering and isosurface, as in `render`.
    background : float or (float, float, float), optional
        Radiance of what is seen behind the volume, in place of that part of the environment; by
        default 0.02, nearly black. None shows the environment.
    azimuth : float, default 30
        Where the camera stands [degrees]: 0 is the patient's front, or -y; 90 the left side, or +x.
    elevation : float, default 20
        How high the camera stands [degrees, -90 to 90].
    density : float, default 1
        By which the transfer function's extinction is multiplied, above 0.
    all_around : bool, default False
        Whether the camera stands so far away that nothing is cut off from any azimuth, as in films.
    **settings : number, str, bool or dict
        Further parameters of the integrator, which `brdfkit plugins RENDERER` lists, such as
        ``max_depth=8``, ``phase="rayleigh"``, ``level=110``, ``bsdf="dusty_gold"``.

    Returns
    -------
    Rendering
        The picture, and the standard error of each pixel; ``write`` makes an OpenEXR file or a PNG.

    Raises
    ------
    BrdfkitError
        For a volume, a transfer function or an environment that cannot be read, for an unknown
        renderer or parameter, and for a picture larger than the memory that is available.

    Examples
    --------
    >>> render_volume("brain.nii.gz", seconds=10).write("brain.png")    # doctest: +SKIP
    >>> render_volume("smoke", renderer="emission_absorption", spp=4, size=64)    # doctest: +SKIP
    """
    until = None if until is None else to_positive("until", until)
    limit = None if seconds is None else to_positive("seconds", seconds)
    most = (UNLIT_SPP if renderer in UNLIT else SPP) if until is None and limit is None else MOST
    spp = to_whole_number("spp", most if spp is None else spp, least=1)
    seed, size = to_whole_number("seed", seed, least=0), to_size(size)
    view = to_number("azimuth", azimuth), to_number("elevation", elevation)
    light = envmap, _to_background(background)
    if renderer not in RENDERERS:
        raise no_such("renderer", renderer, RENDERERS)
    volume = volume if isinstance(volume, Volume) else volumes.load(volume)
    require_memory(size, 1)
    mi = mitsuba()  # sets a variant, on which the dictionaries depend
    if mi.variant().startswith("scalar"):
        raise BrdfkitError(f"Volumes do not render in {mi.variant()}; set llvm_ad_rgb.")
    function = _function(volume, transfer, renderer, to_positive("density", density))
    if function is None and "level" in settings:
        _require_surface(volume, to_number("level", settings["level"]))
    described = volume, function, renderer, size, view, light, settings, all_around
    how = {"progress": progress, "until": until, "limit": limit, "most": PASS}
    traced = _load_and_trace(described, spp=spp, seed=seed, **how)
    words = {name: value if _is_plain(value) else str(value) for name, value in settings.items()}
    shown = {"renderer": renderer, "transfer": getattr(function, "name", None), **words}
    return rendering_of(traced, seed, until, {volume.name: shown})


@in_turn
def _load_and_trace(described, **how):
    """The result of `trace` for a scene; it is freed as this function returns, in its turn."""
    import mitsuba as mi

    volume, *_ = described
    loaded = load_by_mitsuba(mi.load_dict, scene(*described), volume.name)
    return trace({volume.name: loaded}, **how)


def _is_plain(value):
    return isinstance(value, bool | int | float | str)


def _function(volume, transfer, renderer, density):
    """The `TransferFunction` to show; None for the surface of a level."""
    if transfer is None and renderer == "isosurface":
        return None
    if transfer is None:
        transfer = looks.transfer_function(volume, renderer)
    elif not isinstance(transfer, TransferFunction):
        transfer = TransferFunction.load(transfer)
    transfer = fitted(transfer, volume.values)  # the camera wants to know what shows
    if volume.unit and transfer.length_unit:
        transfer = transfer.per(volume.unit)
    return replace(transfer, extinction=density * transfer.extinction)


def _require_surface(volume, level):
    """Raise `BrdfkitError` where no surface of a volume has this value."""
    low, high = volume.range
    if not low <= level <= high:
        raise BrdfkitError(
            f"level = {level:g} is outside the values of {volume.name}, {low:.6g} to {high:.6g}: "
            "there is no surface; give one between."
        )


def _to_background(background):
    """Radiance as a float or three; None stays."""
    if background is None:
        return None
    try:
        found = np.broadcast_to(np.array(background, float), 3)
    except (TypeError, ValueError):
        found = np.full(3, -1.0)
    if not (np.isfinite(found).all() and (found >= 0).all()):
        raise BrdfkitError(
            f"background = {background!r} should be one radiance, or R, G, B, at least 0."
        )
    return found.tolist()
