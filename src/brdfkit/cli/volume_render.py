"""`brdfkit render` of a volume: its options, and its picture."""

import functools
from pathlib import Path

import click

import brdfkit
from brdfkit.cli.errors import say
from brdfkit.cli.settings import parse_settings
from brdfkit.core.errors import BrdfkitError, nearest, no_such

# by the names of their files: to import them takes a second
PRESETS = (Path(brdfkit.__file__).parent / "volumes" / "transfer" / "presets").glob("*.json")
NUMBER = {"type": float, "metavar": "NUMBER"}
OPTIONS = {
    "--renderer": {
        "metavar": "NAME",
        "help": "single_scattering, emission_absorption, maximum_intensity or isosurface. "
        "Default: single_scattering.",
    },
    "--transfer": {
        "metavar": "NAME|FILE",
        "help": f"Transfer function: {', '.join(sorted(path.stem for path in PRESETS))}; or .json. "
        "Default: by the data.",
    },
    "--density": NUMBER | {"help": "Multiply the transfer function's extinction by this number."},
    "--azimuth": NUMBER
    | {"help": "Where the camera stands [degrees]: 0 is in front. Default: 30."},
    "--elevation": NUMBER | {"help": "How high the camera stands [degrees]. Default: 20."},
    "--background": NUMBER | {"help": "Radiance of the background, 0 is black. Default: 0.02."},
    "--seconds": NUMBER | {"help": "Add samples for so long [s]."},
    "--orbit": {
        "type": click.IntRange(min=2),
        "metavar": "FRAMES",
        "help": "Make a film once around it, .gif, .png or .webp. Default size: 320.",
    },
    "--labels": {"is_flag": True, "help": "The values are labels, not densities."},
    "--downsample": {
        "type": click.IntRange(min=1),
        "metavar": "N",
        "help": "Make one voxel of N×N×N while it is read.",
    },
}


def volume_options(command):
    """Adds OPTIONS to a command; it gets `of_volume`, the values of those that were given."""
    names = [option.removeprefix("--") for option in OPTIONS]

    @functools.wraps(command)
    def with_given(*args, **kwargs):
        values = {name: kwargs.pop(name) for name in names}
        given = {name: v for name, v in values.items() if not (v is None or v is False)}
        return command(*args, of_volume=given, **kwargs)

    for option, how in reversed(OPTIONS.items()):
        text = {"help": f"Of a volume: {how['help'][0].lower()}{how['help'][1:]}"}
        with_given = click.option(option, **how | text)(with_given)
    return with_given


def the_volume(things, of_volume):
    """The volume that is the one of `things` to render; None where they are materials."""
    from brdfkit.volumes.loading import looks_like_volume

    found = [thing for thing in things if looks_like_volume(thing)]
    if not found and of_volume:
        option = f"--{next(iter(of_volume))}"
        raise BrdfkitError(f"{option} is for volumes only, and {things[0]} is none: leave it out.")
    for thing in things:
        _refuse_nearly_made(thing)
    if found and len(things) > 1:
        raise BrdfkitError(f"{found[0]} is a volume, which is rendered alone: name nothing else.")
    return found[0] if found else None


def _refuse_nearly_made(word):
    """Refuse a word that is no file and more like the name of a made volume than of a material."""
    from brdfkit.core import catalogue
    from brdfkit.model import labels
    from brdfkit.volumes import made

    known = [*labels.models(), *catalogue.list_materials(), *made.list_names()]
    if word in known or labels.is_label(word) or Path(word).suffix or Path(word).exists():
        return
    if nearest(word, known) in made.list_names():
        raise no_such("file, model, material or volume", word, known)


def render_volume(name, of_volume, values, console, **how):
    """The `Rendering`, or with --orbit the `Film`, of the volume of this name or file.

    `of_volume`: options of volumes; `values`: of --set; `how`: what `brdfkit.render_volume` takes.
    """
    from brdfkit import volumes
    from brdfkit.rendering import render_orbit, render_volume
    from brdfkit.volumes.summary.summary import may_be_labels

    loading = {key: of_volume.pop(key) for key in ("labels", "downsample") if key in of_volume}
    settings = parse_settings(values, "--set", free=True)
    with console.progress(f"read {name}"):
        volume = volumes.load(name, **loading)
    if may_be_labels(volume) and "labels" not in loading:
        say(f"{volume.name} may hold labels, not densities: if so, add --labels.")
    _warn_of_units(volume, of_volume.get("transfer"))
    with console.progress("render") as progress:
        given = {key: value for key, value in how.items() if value is not None}
        given |= of_volume | {"settings": settings, "progress": progress}
        frames = given.pop("orbit", None)
        if frames:
            return render_orbit(volume, frames=frames, **given)
        return render_volume(volume, **given)


def _warn_of_units(volume, transfer):
    """Say where a transfer function is for HU, in which air is -1000, and no value is below 0."""
    from brdfkit.volumes import TransferFunction

    low, high = volume.range
    if transfer and low >= 0 and TransferFunction.load(transfer).value_unit == "HU":
        say(
            f"{transfer} is for HU, in which air is -1000; {volume.name} has {low:.6g} to "
            f"{high:.6g}: if these are no HU, leave --transfer out."
        )
