"""Options that several commands share: where results go, scenes, pictures and repairs of data."""

from __future__ import annotations

import functools
from math import isfinite
from pathlib import Path
from typing import Any

import click

import brdfkit
from brdfkit.cli.settings import Command
from brdfkit.core import catalogue
from brdfkit.core.errors import BrdfkitError

SPP = 64  # default number of samples per pixel
MESHES = "your own mesh, .obj or .ply"
SCENE_FILES = (
    f"{MESHES}; or FILE.xml#ID, a scene and the id of the BSDF in it to replace; #ID may be left "
    "out for the id 'material'"
)


class Decibels(click.ParamType):
    """The type of an option's value in decibels: a number above 0, with or without the unit dB."""

    name = "dB"

    def convert(
        self, value: Any, param: click.Parameter | None, ctx: click.Context | None
    ) -> float:
        try:
            decibels = float(str(value).lower().removesuffix("db"))
        except ValueError:
            decibels = 0.0
        if not (decibels > 0 and isfinite(decibels)):
            self.fail(f"{value!r} is no noise floor; give one like 45dB.", param, ctx)
        return decibels


def output_option(help: str, **attributes: Any) -> Any:
    """Return the option -o of a command that writes a file or a folder."""
    kind = click.Path(path_type=Path)
    return click.option("-o", "--output", type=kind, help=help, **attributes)


def prior_option(command: Command) -> Command:
    """Add the option --prior, which gives the argument `prior`, to a command that completes."""
    return click.option(
        "--prior",
        type=click.Path(path_type=Path),
        metavar="FILE",
        help="What is known of other materials, a file of brdfkit prior. Default: brdfkit's own.",
    )(command)


def mend_options(command: Command) -> Command:
    """Add --mirror-azimuth and --divide-by-cos to a command that reads a measured material.

    The command gets those that the user gave as `mends`, arguments of `Measured.mend`.
    """

    @click.option(
        "--mirror-azimuth",
        is_flag=True,
        help="Add 180° to phi_o of FILE, whose mirror direction is at phi_o = phi_i.",
    )
    @click.option(
        "--divide-by-cos",
        is_flag=True,
        help="Divide the values of FILE, which are BRDF times cos theta_o, by this cosine.",
    )
    @functools.wraps(command)
    def call_with_mends(*args: Any, **kwargs: Any) -> Any:
        given = {name: kwargs.pop(name) for name in ("mirror_azimuth", "divide_by_cos")}
        mends = {name: True for name, is_given in given.items() if is_given}
        return command(*args, mends=mends, **kwargs)

    return call_with_mends


def output_options(command: Command) -> Command:
    """Add --json and --quiet to a command that prints a result; it gets a `console` instead."""

    @click.option("--json", "as_json", is_flag=True, help="Print the result as JSON.")
    @click.option("-q", "--quiet", is_flag=True, help="Print only errors, and what --json prints.")
    @functools.wraps(command)
    def call_with_console(*args: Any, as_json: bool, quiet: bool, **kwargs: Any) -> Any:
        from brdfkit.cli.console import Console

        return command(*args, console=Console(as_json, quiet), **kwargs)

    return call_with_console


def writing_options(command: Command) -> Command:
    """Add --force, --json and --quiet to a command that writes files; see `outputs.py`."""

    @click.option(
        "--force", is_flag=True, help="Replace existing files that another command wrote."
    )
    @output_options
    @functools.wraps(command)
    def call_without_force(*args: Any, force: bool, **kwargs: Any) -> Any:
        return command(*args, **kwargs)

    return call_without_force


seed_option = click.option(
    "--seed",
    type=click.IntRange(min=0),
    default=0,
    show_default=True,
    metavar="N",
    help="Seed of random numbers.",
)


def render_options(
    command: Command, spp: int = SPP, size: str = "512, or the size in a scene file"
) -> Command:
    """Add --spp, --noise-floor, --size and --seed to a command that renders.

    `spp` and `size` are the defaults that the help states.
    """
    count: dict[str, Any] = {"type": click.IntRange(min=1), "metavar": "N"}
    floor = (
        "Add samples until the noise floor, the PSNR between two renderings with different seeds, "
        "reaches this value; noise at 45dB is hardly visible."
    )
    for option in (
        seed_option,
        click.option("--size", help=f"Side of a picture [pixels]. Default: {size}.", **count),
        click.option("--noise-floor", type=Decibels(), metavar="DECIBELS", help=floor),
        click.option(
            "--spp",
            help="Samples per pixel; with --noise-floor, the largest number of them. "
            f"Default: {spp}; with --noise-floor, as many as are needed.",
            **count,
        ),
    ):
        command = option(command)
    return command


def scene_options(command: Command, files: str = SCENE_FILES) -> Command:
    """Add --scene, --up and --envmap to a command that renders materials.

    `files` says in the help which of the user's files may be scenes. The command gets `scene`,
    which is "FILE.obj#z" for a mesh with --up z, and `environment`.
    """
    # The files' names are listed because importing the scenes takes a second
    folder = Path(brdfkit.__file__).with_name("rendering") / "scenes"
    names = ", ".join(sorted(file.stem for file in folder.glob("[!_]*.py")))
    maps = ", ".join(catalogue.list_environments())

    @functools.wraps(command)
    def call_with_scene(*args: Any, scene: str, up: str | None, **kwargs: Any) -> Any:
        if up is not None:
            if not scene.lower().endswith((".obj", ".ply")):
                raise BrdfkitError(f"--up turns a mesh, .obj or .ply; leave it out for {scene}.")
            scene = f"{scene}#{up}"
        return command(*args, scene=scene, **kwargs)

    for option in (
        click.option(
            "--envmap",
            "environment",
            metavar="NAME|FILE",
            help=f"Environment map that lights the scene instead of the sky: {maps}; or a file, "
            ".exr or .hdr.",
        ),
        click.option(
            "--up",
            type=click.Choice("xyz"),
            help="The axis of a mesh that points up. Default: y, or z where the mesh stands only "
            "that way; a message then says so.",
        ),
        click.option(
            "--scene",
            default="ball",
            show_default=True,
            metavar="SCENE",
            help=f"The scene that shows the material: {names}; {files}.",
        ),
    ):
        call_with_scene = option(call_with_scene)
    return call_with_scene


def tone_options(command: Command) -> Command:
    """Add --tone-mapping, --exposure and --tone-by; the command gets `tone`, a `ToneMapping`."""

    @click.option(
        "--tone-mapping",
        "curve",
        default="range",
        metavar="CURVE",
        show_default=True,
        help="Curve that maps radiance to the PNG's brightness, before the curve of sRGB: range "
        "(which shows 1 as white), reinhard, logarithmic or filmic.",
    )
    @click.option(
        "--exposure",
        type=float,
        default=1.0,
        metavar="FACTOR",
        show_default=True,
        help="Factor on the radiance before tone mapping.",
    )
    @click.option(
        "--tone-by",
        "by",
        default="channel",
        metavar="MEANS",
        show_default=True,
        help="Whether the curve applies to each channel or to the luminance, which keeps colours.",
    )
    @functools.wraps(command)
    def call_with_tone(*args: Any, curve: str, exposure: float, by: str, **kwargs: Any) -> Any:
        from brdfkit.images.tone_mapping import ToneMapping

        return command(*args, tone=ToneMapping(curve, exposure, by), **kwargs)

    return call_with_tone
