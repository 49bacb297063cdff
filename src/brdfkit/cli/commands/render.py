"""`brdfkit render`: renders materials, a scene, a distance field or a volume.

The command recognises the kind of thing by its name. Each kind has one function that renders it;
KINDS lists them.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeAlias

import click

from brdfkit.cli.console import Console
from brdfkit.cli.errors import print_message
from brdfkit.cli.options import (
    SPP,
    output_option,
    render_options,
    scene_options,
    tone_options,
    writing_options,
)
from brdfkit.cli.picture_output import path_trace, write_result
from brdfkit.cli.settings import values_option
from brdfkit.cli.volume_render import find_volume, render_volume, volume_options
from brdfkit.core.errors import BrdfkitError
from brdfkit.core.names import join_words, to_file_stem

if TYPE_CHECKING:
    from brdfkit.images.tone_mapping import ToneMapping
    from brdfkit.rendering import Rendering
    from brdfkit.rendering.film import Film

    Rendered: TypeAlias = tuple[Rendering | Film, Path]  # the result, and the path to write it to


@dataclass(frozen=True)
class Request:
    """The things that a user asks to render, and the options of the command."""

    things: Sequence[str]
    output: Path | None
    preview: bool
    shadows: bool
    tone: ToneMapping
    values: Sequence[str]  # the words PARAMETER=VALUE behind --set
    scene: str
    environment: str | None
    spp: int | None
    noise_floor: float | None
    size: int | None
    seed: int
    volume_settings: dict[str, Any]

    def pick_arguments(self, *names: str) -> dict[str, Any]:
        """Return the options `names`, those of samples and the seed, for `brdfkit.render`."""
        return {name: getattr(self, name) for name in ("spp", "noise_floor", "seed", *names)}

    def require_alone(self, name: str, what: str, *options: str) -> None:
        """Raise `BrdfkitError` if other things are named besides `name`, or `options` are given.

        `what` says in the error what `name` is, such as "a scene".
        """
        if len(self.things) > 1:
            raise BrdfkitError(f"{name} is {what}, which is rendered alone: name nothing else.")
        given = {
            "--set": bool(self.values),
            "--scene": self.scene != "ball",
            "--envmap": self.environment is not None,
            "--size": self.size is not None,
            "--preview": self.preview,
        }
        if any(given[option] for option in options):
            raise BrdfkitError(f"{name} is {what}: leave {join_words(options)} out.")


@click.command()
@click.argument(
    "things", nargs=-1, required=True, metavar="FIT|NAME|FILE|SCENE.xml|FIELD.json|VOLUME..."
)
@output_option("Picture to write: .png, or .exr with a .png beside it. Default: NAME.png.")
@click.option(
    "--plugins",
    "folders",
    multiple=True,
    metavar="PATH",
    help="Folder or file with your own plugins to load first; repeat it for more.",
)
@click.option(
    "--preview",
    is_flag=True,
    help="Show the materials without noise and shadows, lit by --envmap (default: studio). It "
    "takes one to two seconds, mostly to start, and the first time some more to compile; in "
    "Python, further pictures take a tenth of a second.",
)
@click.option(
    "--shadows",
    is_flag=True,
    help="Show the ground and the shadows in a --preview, which then takes about as long as "
    "path tracing with 64 samples.",
)
@tone_options
@values_option
@scene_options
@render_options
@volume_options
@writing_options
def render(folders: Sequence[str], console: Console, **options: Any) -> None:
    """Path-trace materials, a scene or a volume.

    Materials (fits, models, measured files) are rendered side by side, and compared to the first
    one by several metrics. The noise floor, which is the difference between two renderings of the
    first one with different seeds, shows which errors are significant.

    These are rendered alone: a SCENE.xml of Mitsuba, in its own size, and without --spp with its
    own samples per pixel; a FIELD.json, a distance field, under lamps; a VOLUME (.nii, .nrrd, .mha,
    .vti, .tif, .vol, a folder of DICOM, or a made one such as smoke). For a volume, --set sets
    parameters of the renderer, which `brdfkit plugins RENDERER` lists.

    After Ctrl-C, the pictures have the samples that were finished for all of them.
    """
    from brdfkit.mitsuba_bridge.registration.users_plugins import load_plugins

    for folder in folders:
        load_plugins(folder)
    request = Request(**options)
    _refuse_misplaced_words(request)
    for find, render_kind in KINDS:
        if name := find(request):
            result, path = render_kind(name, request, console)
            write_result(result, path, request.tone, console)
            return


def _refuse_misplaced_words(request: Request) -> None:
    """Raise `BrdfkitError` for words that cannot be rendered but belong behind an option."""
    from brdfkit.lighting.environments.map_files import looks_like_map
    from brdfkit.rendering.scene_input.mesh_file import SUFFIXES
    from brdfkit.volumes.loading import looks_like_volume

    for word in request.things:
        if ".xml#" in word.lower():
            raise BrdfkitError(f"{word} is a place for a material: give it as --scene {word}.")
        if word.lower().endswith(SUFFIXES):
            raise BrdfkitError(
                f"{word} is a mesh, which needs a material, as in: render ggx --scene {word}."
            )
        if Path(word).is_file() and looks_like_map(word) and not looks_like_volume(word):
            raise BrdfkitError(
                f"{word} is an environment map, which lights a material, as in: render ggx "
                f"--envmap {word}."
            )
    if request.shadows and not request.preview:
        raise BrdfkitError("--shadows is for --preview: path-traced pictures have them anyway.")


def _find_field(request: Request) -> str | None:
    """Return the first thing that is a file of a distance field."""
    from brdfkit.distance_fields.export.json_files import is_field_file

    return next(filter(is_field_file, request.things), None)


def _render_field(name: str, request: Request, console: Console) -> Rendered:
    """Render the distance field in the file `name`."""
    from brdfkit.distance_fields import load

    options = "--set", "--scene", "--envmap", "--preview"
    request.require_alone(name, "a distance field", *options)
    path = _choose_picture_path(request, name)
    return path_trace(load(name), None, console, **request.pick_arguments("size")), path


def _find_scene(request: Request) -> str | None:
    """Return the first thing that is a scene file."""
    return next((word for word in request.things if word.lower().endswith(".xml")), None)


def _render_scene(name: str, request: Request, console: Console) -> Rendered:
    """Render the scene file `name` with its own camera, size and number of samples."""
    options = "--set", "--scene", "--envmap", "--size", "--preview"
    request.require_alone(name, "a scene", *options)
    path = _choose_picture_path(request, name)
    return path_trace(name, None, console, **request.pick_arguments()), path


def _render_volume(name: str, request: Request, console: Console) -> Rendered:
    """Render the volume `name`, or a film of it with --orbit."""
    from brdfkit.cli.arguments import check_film_path

    request.require_alone(name, "a volume", "--scene", "--preview")
    stem = to_file_stem(Path(name).name.partition(".")[0])
    if "orbit" in request.volume_settings:
        path = check_film_path(request.output or f"{stem}.gif")
    else:
        path = _choose_picture_path(request, stem)
    how = request.pick_arguments("size", "environment")
    return render_volume(name, request.volume_settings, request.values, console, **how), path


def _render_materials(name: str, request: Request, console: Console) -> Rendered:
    """Render materials side by side: path-traced, or quickly with --preview."""
    from brdfkit.cli.arguments import check_picture_path, find_material

    materials = [find_material(word, request.values) for word in request.things]
    if request.values:
        _warn_of_energy_gain(materials)
    path = check_picture_path(request.output or f"{to_file_stem(materials[0].name)}.png")
    if request.preview:
        return _render_preview(materials, request), path
    how = request.pick_arguments("size", "scene", "environment")
    return path_trace(materials, SPP, console, **how), path


def _render_preview(materials: Sequence[Any], request: Request) -> Rendering:
    """Render a preview of materials, without noise."""
    from brdfkit.rendering.previewing.preview import SIZE, SPP, STUDIO, preview

    if request.noise_floor is not None or request.seed:
        raise BrdfkitError("A preview has no noise: leave --noise-floor and --seed out.")
    return preview(
        materials,
        spp=request.spp or SPP,
        size=request.size or SIZE,
        scene=request.scene,
        environment=request.environment or STUDIO,
        shadows=request.shadows,
    )


# For each kind of thing, a function that finds it among the words, and one that renders it
KINDS: tuple[tuple[Callable[[Request], str | None], Callable[..., Rendered]], ...] = (
    (_find_field, _render_field),
    (_find_scene, _render_scene),
    (lambda request: find_volume(request.things, request.volume_settings), _render_volume),
    (lambda request: request.things[0], _render_materials),  # all else is a material
)


def _choose_picture_path(request: Request, name: str) -> Path:
    """Check that the picture can be written; return its path, by default `name` with .png."""
    from brdfkit.cli.arguments import check_picture_path

    return check_picture_path(request.output or Path(f"{Path(name).stem}.png"))


def _warn_of_energy_gain(models: Sequence[Any]) -> None:
    """Print a warning for each model that reflects more light than arrives."""
    from brdfkit.regression.albedo import LARGEST_ALBEDO, format_light_share, make_albedo_pixels

    for model in models:
        albedo = float(make_albedo_pixels((5.0, 45.0, 75.0)).evaluate(model.eval).max())
        if albedo > LARGEST_ALBEDO:
            print_message(
                f"{model.name} reflects {format_light_share(albedo)} of the light, "
                "more than arrives."
            )
