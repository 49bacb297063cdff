"""`brdfkit render`: renders materials, a scene or a volume."""

from dataclasses import replace
from pathlib import Path

import click

from brdfkit.cli.errors import say
from brdfkit.cli.options import (
    SPP,
    render_options,
    scene_options,
    tone_options,
    values_option,
    writing_options,
)
from brdfkit.cli.volume_render import render_volume, the_volume, volume_options
from brdfkit.core.errors import BrdfkitError
from brdfkit.core.interrupts import exit_status


@click.command()
@click.argument(
    "things", nargs=-1, required=True, metavar="FIT|NAME|FILE|SCENE.xml|FIELD.json|VOLUME..."
)
@click.option(
    "-o",
    "--output",
    type=click.Path(path_type=Path),
    help="Picture to write: .exr, with a .png beside it, or .png. Default: NAME.png.",
)
@click.option(
    "--plugins",
    "folders",
    multiple=True,
    metavar="PATH",
    help="Folder or file with plugins of yours to load first; repeat it for more.",
)
@click.option(
    "--preview",
    "quickly",
    is_flag=True,
    help="Show the light of --envmap, by default studio, without noise or shadows. It takes a few "
    "seconds, most of them to start; in Python the next pictures take a tenth of a second.",
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
def render(
    things,
    output,
    folders,
    quickly,
    shadows,
    tone,
    values,
    scene,
    environment,
    spp,
    noise_floor,
    size,
    seed,
    of_volume,
    console,
):
    """Path-trace materials, a scene or a volume.

    Materials (fits, models, measured files) are rendered side by side. The others are compared to
    the first, by several metrics, beside their noise floor: the first with another seed. A
    SCENE.xml of Mitsuba's is rendered alone, in its own size, and without --spp with its own
    samples per pixel; a FIELD.json of distances alone, too, under lamps. A VOLUME, .nii, .nrrd,
    .mha, .vti, .tif, .vol, a folder of DICOM, or a made one such as smoke, is rendered alone; --set
    gives parameters of its renderer, which `brdfkit plugins RENDERER` lists. Ctrl-C keeps the
    samples that all pictures have.
    """
    from brdfkit.cli.arguments import film_file, material, picture_file
    from brdfkit.core.names import to_file_stem
    from brdfkit.distance_fields import load as load_field
    from brdfkit.distance_fields.export.json_files import is_field_file
    from brdfkit.lighting.environments.map_files import looks_like_map
    from brdfkit.mitsuba_bridge.registration.users_plugins import load_plugins
    from brdfkit.rendering.scene_input.mesh_file import SUFFIXES
    from brdfkit.volumes.loading import looks_like_volume

    for folder in folders:
        load_plugins(folder)
    scenes = [t for t in things if t.lower().endswith(".xml")]
    for place in (t for t in things if ".xml#" in t.lower()):
        raise BrdfkitError(f"{place} is a place for a material: give it as --scene {place}.")
    for mesh in (t for t in things if t.lower().endswith(SUFFIXES)):
        raise BrdfkitError(
            f"{mesh} is a mesh, which needs a material: render ggx --scene {mesh}, for instance."
        )
    for light in (t for t in things if Path(t).is_file() and looks_like_map(t)):
        if not looks_like_volume(light):
            raise BrdfkitError(
                f"{light} is an environment map, which lights a material: render ggx --envmap "
                f"{light}, for instance."
            )
    if shadows and not quickly:
        raise BrdfkitError("--shadows is for --preview: path-traced pictures have them anyway.")
    fields = [t for t in things if is_field_file(t)]
    if fields:
        if len(things) > 1 or values or scene != "ball" or environment is not None or quickly:
            raise BrdfkitError(
                f"{fields[0]} is a distance field: it is rendered alone, without --set, --scene, "
                "--envmap and --preview."
            )
        output = picture_file(output or Path(fields[0]).with_suffix(".png").name)
        where = {"size": size, "seed": seed}
        field = load_field(fields[0])
        picture = path_trace(field, output, console, spp, noise_floor, tone, usual=None, **where)
    elif scenes:
        if len(things) > 1 or values:
            raise BrdfkitError("A scene is rendered alone and without --set: name one SCENE.xml.")
        if scene != "ball" or environment is not None or size or quickly:
            raise BrdfkitError(
                f"{scenes[0]} is a scene: leave --scene, --envmap, --size and --preview out."
            )
        output = picture_file(output or Path(scenes[0]).with_suffix(".png").name)
        where = {"seed": seed}
        scene = scenes[0]
        picture = path_trace(scene, output, console, spp, noise_floor, tone, usual=None, **where)
    elif volume := the_volume(things, of_volume):
        if scene != "ball" or quickly:
            raise BrdfkitError(f"{volume} is a volume: leave --scene and --preview out.")
        turns = "orbit" in of_volume
        name = to_file_stem(Path(volume).name.partition(".")[0])
        output = output or Path(f"{name}.gif" if turns else f"{name}.png")
        output = film_file(output) if turns else picture_file(output)
        how = {"spp": spp, "noise_floor": noise_floor, "size": size, "seed": seed}
        how["environment"] = environment
        picture = render_volume(volume, of_volume, values, console, **how)
        if turns:
            _end_with_film(picture, output, tone, console)
            return
        _write(picture, output, tone)
    else:
        found = [material(thing, values) for thing in things]
        if values:
            _warn_of_gains(found)
        output = picture_file(output or f"{to_file_stem(found[0].name)}.png")
        where = {"size": size, "seed": seed, "scene": scene, "environment": environment}
        if quickly:
            picture = _preview(found, output, spp, noise_floor, shadows, tone, **where)
        else:
            picture = path_trace(found, output, console, spp, noise_floor, tone, **where)
    _print_picture(picture, output, console)
    if picture.spp < picture.requested:
        click.get_current_context().exit(exit_status())


def _warn_of_gains(models):
    """Say which models reflect more light than arrives, by the values that were set."""
    from brdfkit.regression.light import LARGEST_ALBEDO, format_share, make_albedo_pixels

    for model in models:
        most = float(make_albedo_pixels((5.0, 45.0, 75.0)).look(model.eval).max())
        if most > LARGEST_ALBEDO:
            say(f"{model.name} reflects {format_share(most)} of the light, more than arrives.")


def path_trace(things, output, console, spp, noise_floor, tone="range", usual=SPP, **where):
    """Render `things` side by side and write the picture; returns a `Rendering`.

    `tone`: a `ToneMapping` or the name of one; `usual`: samples per pixel where neither `spp` nor
    `noise_floor` is given; `where`: other arguments of `brdfkit.render`.
    """
    from brdfkit.rendering.render_materials import render as render_things

    with console.progress("render") as progress:
        spp = spp or (usual if noise_floor is None else None)
        picture = render_things(
            things, spp=spp, noise_floor=noise_floor, progress=progress, **where
        )
    _write(picture, output, tone)
    return picture


def _preview(things, output, spp, noise_floor, shadows, tone, scene, environment, size, seed):
    """Preview `things` and write the picture; returns a `Rendering`."""
    from brdfkit.rendering.previewing.preview import SIZE, SPP, STUDIO, preview

    if noise_floor is not None or seed:
        raise BrdfkitError("A preview has no noise: leave --noise-floor and --seed out.")
    size, spp = size or SIZE, spp or SPP
    picture = preview(
        things, environment=environment or STUDIO, size=size, scene=scene, spp=spp, shadows=shadows
    )
    _write(picture, output, tone)
    return picture


def _end_with_film(film, output, tone, console):
    """Write a `Film` and print what it is; ends the command where it was interrupted."""
    replace(film, tone_mapping=tone).write(output)
    shown, requested = len(film.frames), film.requested
    if shown < requested:
        say(f"interrupted; the film has {shown} of {requested} frames.")
    if console.as_json:
        counts = {"frames": shown, "requested": requested, "spp": film.spp, "seconds": film.seconds}
        console.json(counts | {"written": [output]})
    else:
        console.out.print(str(film))
        console.list_written([output])
    if shown < requested:
        click.get_current_context().exit(exit_status())


def _write(picture, output, tone):
    """Write a `Rendering`, and say so where it was interrupted or is not as good as asked for."""
    picture.tone_mapped(tone).write(output)
    if picture.spp < picture.requested:
        say(f"interrupted; rendered with {picture.spp} of {picture.requested} samples per pixel.")
    elif picture.shortfall:
        say(picture.shortfall)


def _print_picture(picture, path, console):
    """Print what was rendered, and the files that were written."""
    written = [path]
    if path.suffix.lower() == ".exr":
        written += [path.with_suffix(".png")]
    if console.as_json:
        console.json(
            {
                "pictures": list(picture.pictures),
                "psnr": picture.psnr(),
                "errors": picture.errors(),
                "spp": picture.spp,
                "seconds": picture.seconds,
                "written": written,
            }
        )
        return
    if picture.differences:
        console.out.print(picture.head)
        console.print_image_errors(picture.errors())
    else:
        console.out.print(str(replace(picture, requested_noise_floor=None)))  # `_write` said it
    console.list_written(written)
