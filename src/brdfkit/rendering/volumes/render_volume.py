"""`render_volume`: a picture of CT, MRI, microscopy or simulation data in light."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any, TypeAlias

import numpy as np

from brdfkit import volumes
from brdfkit.core.arguments import to_dictionary, to_number, to_positive_number, to_whole_number
from brdfkit.core.errors import BrdfkitError, no_such_error
from brdfkit.core.jit.threads import in_turn
from brdfkit.core.memory import require_memory
from brdfkit.mitsuba_bridge.properties.picture_file import load_by_mitsuba
from brdfkit.rendering.render_materials import PictureProgress, to_picture_size, to_rendering
from brdfkit.rendering.result import Rendering
from brdfkit.rendering.scene_input.arguments import load_mitsuba
from brdfkit.rendering.tracing import Traced, trace_scenes
from brdfkit.rendering.volumes import defaults
from brdfkit.rendering.volumes.scene import RENDERERS, UNLIT, describe_scene
from brdfkit.volumes import TransferFunction, Volume
from brdfkit.volumes.transfer.transfer_function import TransferLike
from brdfkit.volumes.transfer.windows import scale_transfer_to_values

SPP, UNLIT_SPP = 64, 8  # default samples per pixel, for renderers with light and without light
MOST_SPP = 16_384  # default limit of the samples per pixel if a noise floor or a time is requested
PASS_SPP = 4  # samples per pixel in a pass: few, so that the first picture appears soon
BACKGROUND = 0.02  # default radiance behind the volume

VolumeLike: TypeAlias = Volume | str | Path
Radiance: TypeAlias = float | tuple[float, float, float]


def render_volume(
    volume: VolumeLike,
    transfer: TransferLike | None = None,
    *,
    renderer: str = "single_scattering",
    settings: Mapping[str, Any] | None = None,
    spp: int | None = None,
    size: int | tuple[int, int] = 512,
    environment: str | Path = "studio",
    background: Radiance | None = BACKGROUND,
    azimuth: float = 30.0,
    elevation: float = 20.0,
    density: float = 1.0,
    all_around: bool = False,
    noise_floor: float | None = None,
    seconds: float | None = None,
    seed: int = 0,
    progress: PictureProgress | None = None,
) -> Rendering:
    """Render a volume: CT, MRI, microscopy or simulation data in the light of an environment.

    The picture contains all visible parts of the volume, and patients are upright. The current
    variant of Mitsuba is used or, if none is set, the best one that works. Ctrl-C keeps the passes
    that are finished.

    Parameters
    ----------
    volume : Volume, str or Path
        The volume; or the file, folder or name that `brdfkit.volumes.load` takes.
    transfer : TransferFunction, str or Path, optional
        Colour and extinction as a function of the volume's values: a transfer function, the name of
        a preset, or a file. By default a colour for each label; for scans in HU "ct_bone", or
        "ct_skin" if there is no bone; for other scans of patients "mri_head" over the volume's
        `window`; otherwise a colour map over the window.
    renderer : str, default "single_scattering"
        "single_scattering": light of the environment, scattered once; "emission_absorption": a
        glowing and absorbing medium; "maximum_intensity": the largest value along each ray;
        "isosurface": the lit surface on which the values have one level.
    settings : dict of str to object, optional
        Other parameters of the renderer, which `brdfkit plugins RENDERER` lists, as
        ``{"max_depth": 8, "phase": "rayleigh"}`` or ``{"level": 110, "bsdf": "dusty_gold"}``.
    spp : int, optional
        Samples per pixel, by default 64, or 8 for renderers without light from outside, whose noise
        is then not visible. With `noise_floor` or `seconds` the largest number, by default
        16,384.
    size : int or (int, int), default 512
        Side, or width and height, of the picture [pixels].
    environment : str or Path, default "studio"
        The environment map that lights single_scattering and isosurface, as in `render`.
    background : float or (float, float, float), optional
        Radiance behind the volume, in place of that part of the environment; by default 0.02,
        nearly black. None shows the environment.
    azimuth : float, default 30
        Azimuth of the camera [degrees]: 0 is the patient's front, or -y; 90 the left side, or +x.
    elevation : float, default 20
        Elevation of the camera [degrees, -90 to 90].
    density : float, default 1
        Factor of the transfer function's extinction, above 0.
    all_around : bool, default False
        Whether the camera is so far away that nothing would be cut off at any azimuth, as in films.
    noise_floor : float, optional
        The noise floor to reach by adding samples [dB, above 0]: the PSNR of the picture to itself
        with another seed. At 45 noise is hardly visible.
    seconds : float, optional
        Time for which samples are added [s, above 0]; there is at least one pass.
    seed : int, default 0
        Seed of the samples.
    progress : callable, optional
        Called with (done, total) after each pass; see `brdfkit.progress`. A function with a
        parameter `pictures` also gets a function: ``pictures()[volume.name]`` is the picture so
        far.

    Returns
    -------
    Rendering
        The picture, and the standard error of each pixel; ``write`` makes an OpenEXR file or a PNG.

    Raises
    ------
    BrdfkitError
        For a volume, a transfer function or an environment that cannot be read, for an unknown
        renderer or parameter, and for a picture larger than the available memory.

    Examples
    --------
    >>> render_volume("brain.nii.gz", seconds=10).write("brain.png")    # doctest: +SKIP
    >>> render_volume("smoke", renderer="emission_absorption", spp=4, size=64)    # doctest: +SKIP
    """
    settings = to_dictionary("settings", settings)
    noise_floor = None if noise_floor is None else to_positive_number("noise_floor", noise_floor)
    limit = None if seconds is None else to_positive_number("seconds", seconds)
    most = (
        (UNLIT_SPP if renderer in UNLIT else SPP)
        if noise_floor is None and limit is None
        else MOST_SPP
    )
    spp = to_whole_number("spp", most if spp is None else spp, least=1)
    seed, size = to_whole_number("seed", seed, least=0), to_picture_size(size)
    view = to_number("azimuth", azimuth), to_number("elevation", elevation)
    light = environment, _to_background_rgb(background)
    if renderer not in RENDERERS:
        raise no_such_error("renderer", renderer, RENDERERS)
    volume = volume if isinstance(volume, Volume) else volumes.load(volume)
    require_memory(size, 1)
    mi = load_mitsuba()  # it sets Mitsuba's variant, on which the dictionaries of scenes depend
    if mi.variant().startswith("scalar"):
        raise BrdfkitError(f"Volumes do not render in {mi.variant()}; set llvm_ad_rgb.")
    function = _choose_transfer_function(
        volume, transfer, renderer, to_positive_number("density", density)
    )
    if function is None and "level" in settings:
        _require_surface(volume, to_number("level", settings["level"]))
    described = volume, function, renderer, size, view, light, settings, all_around
    limits = {"progress": progress, "noise_floor": noise_floor, "limit": limit, "most": PASS_SPP}
    traced = _load_and_trace_volume(described, spp=spp, seed=seed, **limits)
    # Other types than these cannot be written to the header of an EXR file
    plain = {
        n: v if isinstance(v, bool | int | float | str) else str(v) for n, v in settings.items()
    }
    parameters = {"renderer": renderer, "transfer": getattr(function, "name", None), **plain}
    return to_rendering(traced, seed, noise_floor, {volume.name: parameters})


@in_turn
def _load_and_trace_volume(described: tuple[Any, ...], **settings: Any) -> Traced:
    """Path-trace the scene of a volume.

    `described` are the arguments of `describe_scene`, and `settings` further arguments of
    `trace_scenes`. The scene is freed when this function returns, before another thread renders.
    """
    import mitsuba as mi

    volume, *_ = described
    loaded = load_by_mitsuba(mi.load_dict, describe_scene(*described), volume.name)
    return trace_scenes({volume.name: loaded}, **settings)


def _choose_transfer_function(
    volume: Volume, transfer: TransferLike | None, renderer: str, density: float
) -> TransferFunction | None:
    """Return the transfer function to show, in the volume's unit of length.

    `transfer` is what the user gave, and `density` a factor of the extinction. The result is None
    if the picture shows the surface on which the values have one level.
    """
    if transfer is None and renderer == "isosurface":
        return None
    if transfer is None:
        transfer = defaults.choose_transfer_function(volume, renderer)
    elif not isinstance(transfer, TransferFunction):
        transfer = TransferFunction.load(transfer)
    # Scaled here already, as the place of the camera depends on which voxels are opaque
    transfer = scale_transfer_to_values(transfer, volume.values)
    if volume.unit and transfer.length_unit:
        transfer = transfer.per(volume.unit)
    return replace(transfer, extinction=density * transfer.extinction)


def _require_surface(volume: Volume, level: float) -> None:
    """Raise `BrdfkitError` if no surface exists, because `level` is beyond the volume's values."""
    low, high = volume.range
    if not low <= level <= high:
        raise BrdfkitError(
            f"level = {level:g} is outside the values of {volume.name}, {low:.6g} to {high:.6g}: "
            "there is no surface; give one between."
        )


def _to_background_rgb(background: Radiance | None) -> list[float] | None:
    """Return the radiance of the background as R, G, B; None stays None."""
    if background is None:
        return None
    try:
        rgb = np.broadcast_to(np.array(background, float), 3)
    except (TypeError, ValueError):
        rgb = np.full(3, -1.0)  # an invalid radiance, so that the error below is raised
    if not (np.isfinite(rgb).all() and (rgb >= 0).all()):
        raise BrdfkitError(
            f"background = {background!r} should be one radiance, or R, G, B, at least 0."
        )
    return [float(value) for value in rgb]
