"""Options that several commands have."""

import functools
from math import isfinite
from pathlib import Path

import click

import brdfkit
from brdfkit.cli.settings import parse_settings
from brdfkit.core import catalogue
from brdfkit.core.errors import BrdfkitError

SPP = 64  # samples per pixel
MESHES = "a mesh of yours, .obj or .ply"
SCENE_FILES = (
    f"{MESHES}; or FILE.xml#ID, a scene, and in it the BSDF to replace, which need not be named if "
    "it is 'material'"
)


class Decibels(click.ParamType):
    """A number above 0, with or without dB behind it."""

    name = "dB"

    def convert(self, value, param, ctx):
        try:
            found = float(str(value).lower().removesuffix("db"))
        except ValueError:
            found = 0.0
        if not (found > 0 and isfinite(found)):
            self.fail(f"{value!r} is no noise floor; give one like 45dB.", param, ctx)
        return found


def fit_options(default, others="FILE.py with one, or best"):
    """Adds -m, --loss and other options to a command that fits; it gets `names`, the models, and
    `how`, the settings of `fit`.

    In words, `default`: which models without -m; `others`: what -m takes beside a model.
    """

    def add(command):
        @functools.wraps(command)
        def with_settings(
            *args,
            loss,
            robust,
            solver,
            albedo_at_most,
            max_angle,
            fixed,
            bounds,
            anisotropic,
            **kwargs,
        ):
            from brdfkit.regression.solvers import AlbedoAtMost

            _require_one_each(kwargs["names"])
            how = {"loss": loss, "robust": robust, "solver": solver, "max_angle": max_angle}
            how |= {"fixed": parse_settings(fixed, "--fixed"), "anisotropic": anisotropic}
            how["bounds"] = parse_settings(bounds, "--bound", "LOW,HIGH")
            how["constraints"] = () if albedo_at_most is None else AlbedoAtMost(albedo_at_most)
            return command(*args, how=how, **kwargs)

        for option in reversed(_fit_options(default, others)):
            with_settings = option(with_settings)
        return with_settings

    return add


def _require_one_each(names):
    """Refuse several models in one -m, such as ggx,ward."""
    from brdfkit.model import labels

    for name in names:
        parts = name.split(",")
        if len(parts) > 1 and all(map(labels.is_label, parts)):
            raise BrdfkitError(f"{name} are several models; repeat -m: -m {' -m '.join(parts)}.")


def _fit_options(default, others):
    """The options of `fit_options`."""
    return (
        click.option(
            "-m",
            "--model",
            "names",
            multiple=True,
            metavar="MODEL",
            help=f"A model, {others}; repeat it for more. Default: {default}.",
        ),
        click.option(
            "--loss",
            default="cbrt",
            metavar="LOSS",
            show_default=True,
            help="What the fit minimises: cosine, log, cbrt, plain, lafortune, relative, kurt "
            "or picture; print(brdfkit.losses.named) in Python says what each is.",
        ),
        click.option(
            "--robust",
            metavar="WEIGHTS",
            help="Give outliers little weight: andrews, bisquare, cauchy, fair, huber, logistic, "
            "talwar or welsch.",
        ),
        click.option(
            "--solver",
            metavar="SOLVER",
            help="What searches: levenberg_marquardt, slsqp, trust_region or "
            "differential_evolution.",
        ),
        click.option(
            "--albedo-at-most",
            type=float,
            metavar="LIMIT",
            help="Let no model reflect more than this share of the light, at 0°, 30°, 60°, 75°, "
            "85°, 89°.",
        ),
        click.option(
            "--max-angle",
            default=80.0,
            show_default=True,
            help="Use the samples with both angles below this one [degrees].",
        ),
        click.option(
            "--fixed",
            multiple=True,
            metavar="NAME=VALUE",
            help="Keep a shape parameter at a value, as f0=0.04; repeat it for more.",
        ),
        click.option(
            "--bound",
            "bounds",
            multiple=True,
            metavar="NAME=LOW,HIGH",
            help="Search a shape parameter between these, as alpha_u=0.01,0.5; repeat it for more.",
        ),
        click.option(
            "--anisotropic/--isotropic",
            default=None,
            help="Whether alpha_v and similar parameters are searched, or follow alpha_u. "
            "Default: as the measurement is.",
        ),
    )


def mend_options(command):
    """Adds --mirror-azimuth and --divide-by-cos to a command that reads a material; it gets
    `mends`, those that were given, as arguments of `Measured.mend`."""

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
    def with_mends(*args, mirror_azimuth, divide_by_cos, **kwargs):
        given = {"mirror_azimuth": mirror_azimuth, "divide_by_cos": divide_by_cos}
        mends = {name: True for name, is_given in given.items() if is_given}
        return command(*args, mends=mends, **kwargs)

    return with_mends


def output_options(command):
    """Adds --json and --quiet to a command that prints a result; it gets a `Console` instead."""

    @click.option("--json", "as_json", is_flag=True, help="Print the result as JSON.")
    @click.option("-q", "--quiet", is_flag=True, help="Print errors only, and JSON if asked for.")
    @functools.wraps(command)
    def with_output(*args, as_json, quiet, **kwargs):
        from brdfkit.cli.console import Console

        return command(*args, console=Console(as_json, quiet), **kwargs)

    return with_output


def writing_options(command):
    """Adds --force, --json and --quiet to a command that writes files; see `outputs.py`."""

    @click.option("--force", is_flag=True, help="Replace files that another command wrote.")
    @output_options
    @functools.wraps(command)
    def with_force(*args, force, **kwargs):
        return command(*args, **kwargs)

    return with_force


def render_options(command, spp=SPP, size="512, or what a scene file has"):
    """Adds --spp, --noise-floor, --size and --seed to a command that renders.

    `spp`, `size`: what they are by default, in words.
    """
    count = {"type": click.IntRange(min=1), "metavar": "N"}
    seed = {"type": click.IntRange(min=0), "metavar": "N"}
    floor = "Noise floor, as a PSNR, to reach by adding samples; 45dB is hardly visible."
    for option in (
        click.option("--seed", default=0, show_default=True, help="Seed of the samples.", **seed),
        click.option("--size", help=f"Side of a picture [pixels]. Default: {size}.", **count),
        click.option("--noise-floor", type=Decibels(), metavar="DECIBELS", help=floor),
        click.option(
            "--spp",
            help="Samples per pixel; with --noise-floor the largest number. "
            f"Default: {spp}, or what it takes.",
            **count,
        ),
    ):
        command = option(command)
    return command


def scene_options(command, files=SCENE_FILES):
    """Adds --scene, --up and --envmap to a command that renders materials; `files`: in words, which
    of the user's may be scenes. The command gets `scene`, "FILE.obj#z" of a mesh with --up z."""
    # by the names of their files: to import the scenes takes a second
    folder = Path(brdfkit.__file__).with_name("rendering") / "scenes"
    names = ", ".join(sorted(file.stem for file in folder.glob("[!_]*.py")))
    maps = ", ".join(catalogue.list_environments())

    @functools.wraps(command)
    def with_scene(*args, scene, up, **kwargs):
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
            help=f"Light by an environment map, not by the sky: {maps}; or .exr or .hdr.",
        ),
        click.option(
            "--up",
            type=click.Choice("xyz"),
            help="Which axis of a mesh points up. Default: y, or z where it stands that way only, "
            "which is then said.",
        ),
        click.option(
            "--scene",
            default="ball",
            show_default=True,
            metavar="SCENE",
            help=f"What shows the material: {names}; {files}.",
        ),
    ):
        with_scene = option(with_scene)
    return with_scene


def tone_options(command):
    """Adds --tone-mapping, --exposure and --tone-by; the command gets `tone`, a `ToneMapping`."""

    @click.option(
        "--tone-mapping",
        "curve",
        default="range",
        metavar="CURVE",
        show_default=True,
        help="How the PNG shows radiance: range (1 is white), reinhard, logarithmic or filmic, "
        "before the curve of sRGB.",
    )
    @click.option(
        "--exposure",
        type=float,
        default=1.0,
        metavar="FACTOR",
        show_default=True,
        help="Multiply radiance by this number before.",
    )
    @click.option(
        "--tone-by",
        "by",
        default="channel",
        metavar="MEANS",
        show_default=True,
        help="What the curve is of: each channel, or luminance, which keeps colours.",
    )
    @functools.wraps(command)
    def with_tone(*args, curve, exposure, by, **kwargs):
        from brdfkit.images.tone_mapping import ToneMapping

        return command(*args, tone=ToneMapping(curve, exposure, by), **kwargs)

    return with_tone


def values_option(command):
    """Adds --set, for the parameters of models."""
    option = click.option(
        "-p",
        "--set",
        "values",
        multiple=True,
        metavar="PARAMETER=VALUE",
        help="Set a parameter of the models, or of the renderer of a volume, to a number or R,G,B; "
        "repeat it for more.",
    )
    return option(command)
