"""The options of `brdfkit render` for volumes, and the rendering of a volume or its film."""

from __future__ import annotations

import functools
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

import brdfkit
from brdfkit.cli.console import Console
from brdfkit.cli.errors import print_message
from brdfkit.cli.settings import Command, parse_settings
from brdfkit.core.errors import BrdfkitError, find_nearest_name, no_such_error

if TYPE_CHECKING:
    from brdfkit.rendering import Rendering
    from brdfkit.rendering.film import Film
    from brdfkit.volumes import Volume

# The files' names are listed because importing the transfer functions takes a second
PRESETS = (Path(brdfkit.__file__).parent / "volumes" / "transfer" / "presets").glob("*.json")
NUMBER = {"type": float, "metavar": "NUMBER"}
VOLUME_OPTIONS: dict[str, dict[str, Any]] = {
    "--renderer": {
        "metavar": "NAME",
        "help": "single_scattering, emission_absorption, maximum_intensity or isosurface. "
        "Default: single_scattering.",
    },
    "--transfer": {
        "metavar": "NAME|FILE",
        "help": f"transfer function, one of {', '.join(sorted(path.stem for path in PRESETS))}, or "
        "a .json file. Default: chosen by the data.",
    },
    "--density": NUMBER | {"help": "factor on the transfer function's extinction. Default: 1."},
    "--azimuth": NUMBER
    | {"help": "angle of the camera around the volume [degrees]; 0 is in front. Default: 30."},
    "--elevation": NUMBER
    | {"help": "angle of the camera above the horizon [degrees]. Default: 20."},
    "--background": NUMBER | {"help": "radiance of the background; 0 is black. Default: 0.02."},
    "--seconds": NUMBER | {"help": "time during which samples are added [s]."},
    "--orbit": {
        "type": click.IntRange(min=2),
        "metavar": "FRAMES",
        "help": "make a film of a camera that circles it once, .gif, .png or .webp. Default size: "
        "320.",
    },
    "--labels": {"is_flag": True, "help": "treat the values as labels, not as densities."},
    "--downsample": {
        "type": click.IntRange(min=1),
        "metavar": "N",
        "help": "combine N×N×N voxels into one while the file is read.",
    },
}


def volume_options(command: Command) -> Command:
    """Add VOLUME_OPTIONS to a command; it gets `volume_settings`, the values that were given."""
    names = [option.removeprefix("--") for option in VOLUME_OPTIONS]

    @functools.wraps(command)
    def call_with_settings(*args: Any, **kwargs: Any) -> Any:
        values = {name: kwargs.pop(name) for name in names}
        settings = {name: v for name, v in values.items() if not (v is None or v is False)}
        return command(*args, volume_settings=settings, **kwargs)

    for option, attributes in reversed(VOLUME_OPTIONS.items()):
        text = {"help": f"For a volume: {attributes['help']}"}
        call_with_settings = click.option(option, **attributes | text)(call_with_settings)
    return call_with_settings


def find_volume(things: Sequence[str], settings: dict[str, Any]) -> str | None:
    """Return the first of the `things` to render that is a volume, or None.

    Raises `BrdfkitError` for `settings` of volumes without a volume, and for misspelt volumes.
    """
    from brdfkit.volumes.loading import looks_like_volume

    volume = next(filter(looks_like_volume, things), None)
    if settings and not volume:
        option = f"--{next(iter(settings))}"
        raise BrdfkitError(f"{option} is for volumes only, and {things[0]} is none: leave it out.")
    for thing in things:
        _refuse_misspelt_volume(thing)
    return volume


def _refuse_misspelt_volume(word: str) -> None:
    """Raise `BrdfkitError` for an unknown word that is probably a misspelt made volume."""
    from brdfkit.core import catalogue
    from brdfkit.model import labels
    from brdfkit.volumes import made

    known = [*labels.models(), *catalogue.list_materials(), *made.list_volume_names()]
    if word in known or labels.is_label(word) or Path(word).suffix or Path(word).exists():
        return
    if find_nearest_name(word, known) in made.list_volume_names():
        raise no_such_error("file, model, material or volume", word, known)


def render_volume(
    name: str, settings: dict[str, Any], values: Sequence[str], console: Console, **how: Any
) -> Rendering | Film:
    """Render the volume of a name or a file, or a film of it if `settings` contains "orbit".

    `settings` are the values of VOLUME_OPTIONS, `values` those of --set, and `how` are arguments
    of `brdfkit.render_volume`.
    """
    from brdfkit import volumes
    from brdfkit.rendering import render_orbit, render_volume

    loading = {key: settings[key] for key in ("labels", "downsample") if key in settings}
    parameters = parse_settings(values, "--set", free=True)
    with console.progress(f"read {name}"):
        volume = volumes.load(name, **loading)
    if "labels" not in loading:
        warn_of_labels(volume)
    _warn_of_units(volume, settings.get("transfer"))
    with console.progress("render") as progress:
        how = {key: value for key, value in how.items() if value is not None}
        how |= {key: value for key, value in settings.items() if key not in loading}
        how |= {"settings": parameters, "progress": progress}
        if "orbit" in how:
            return render_orbit(volume, frames=how.pop("orbit"), **how)
        return render_volume(volume, **how)


def warn_of_labels(volume: Volume) -> None:
    """Print a warning if a volume's values may be labels."""
    from brdfkit.volumes.summary.summary import may_be_labels

    if may_be_labels(volume):
        print_message(f"{volume.name} may hold labels, not densities: if so, add --labels.")


def _warn_of_units(volume: Volume, transfer: str | None) -> None:
    """Print a warning if a transfer function is for HU and the volume has no value below 0.

    In Hounsfield units (HU) air is -1000, so scans have negative values.
    """
    from brdfkit.volumes import TransferFunction

    low, high = volume.range
    if transfer and low >= 0 and TransferFunction.load(transfer).value_unit == "HU":
        print_message(
            f"{transfer} is for HU, in which air is -1000; {volume.name} has {low:.6g} to "
            f"{high:.6g}: if these are no HU, leave --transfer out."
        )
