"""The command line. Everything heavy is imported when a command runs: `--help` is instant."""

from pathlib import Path

import click

from brdfkit import __version__
from brdfkit.command import Group, output_options, render_options, say, values_option
from brdfkit.errors import BrdfkitError


@click.group("brdfkit", cls=Group, context_settings={"help_option_names": ["-h", "--help"]})
@click.version_option(__version__, "-V", "--version", prog_name="brdfkit")
def main():
    """Fit BRDF models to measured materials, and path-trace both.

    \b
    brdfkit info copper.astm -o copper.png
    brdfkit fit copper.astm -m ward -m ggx --render -o copper
    brdfkit render car_paint -o paint.png
    """


@main.command()
@click.argument("name", required=False)
@output_options
def models(name, console):
    """List the models, or show the page of one."""
    from brdfkit import registry

    if name is None:
        console.models(registry.models())
    else:
        console.model(registry.model(name))


@main.command()
@click.argument("file", required=False)
@click.option(
    "-o",
    "--output",
    type=click.Path(path_type=Path),
    help="Picture to write: a slice, the lobes and the albedo; .png, .pdf or .svg.",
)
@output_options
def info(file, output, console):
    """Audit a measured FILE: what it holds and what is doubtful.

    How much of the hemisphere was measured, noise, reciprocity, albedo, spikes and more. Without
    FILE, list the materials that brdfkit brings; `brdfkit data` lists public ones.
    """
    from brdfkit import catalogue
    from brdfkit.targets import figure_file, measured, write_figure

    if file is None and output:
        raise BrdfkitError("A picture shows a measurement: name a FILE.")
    if file is None:
        console.materials(catalogue.materials())
        return
    output = output and figure_file(output)
    with console.progress(f"read {file}"):
        material = measured(file)
    with console.progress("audit"):
        audit = material.audit()
    if output:
        with console.progress("draw"):
            write_figure(audit.picture(), output)
    console.audit(audit, [output] if output else [])


@main.group(invoke_without_command=True)
@output_options
@click.pass_context
def data(context, console):
    """List public measurements, and download them.

    \b
    brdfkit data                                the collections
    brdfkit data list merl                      the materials of one
    brdfkit data get merl/gold-metallic-paint   download a material
    brdfkit fit merl/gold-metallic-paint        use it by its name

    Files are kept in your cache folder. Nothing else downloads anything.
    """
    from brdfkit.catalogue import materials
    from brdfkit.public_collections import cache, collections

    if context.invoked_subcommand is None:
        console.collections(collections(), materials(), cache())


@data.command("list")
@click.argument("collection")
@output_options
def data_list(collection, console):
    """List the materials of a COLLECTION, and how to get each."""
    from brdfkit import public_collections

    console.collection(public_collections.collection(collection))


@data.command("get")
@click.argument("names", nargs=-1, required=True, metavar="NAME...")
@output_options
def data_get(names, console):
    """Download materials, and check their checksums.

    A NAME is as in merl/gold-metallic-paint. An interrupted download goes on where it stopped,
    except that of a file out of an archive (merl).
    """
    from brdfkit.downloading import get
    from brdfkit.public_collections import collection

    collections = {c.name: c for c in map(collection, names)}
    files = {}
    for name in names:
        with console.progress(f"download {name}") as progress:
            files[name] = get(name, progress)
    console.downloaded(files, collections.values())


@main.command()
@click.argument("geometry", metavar="gaussian|brushed|woven")
@click.option("--slope", default=0.3, show_default=True, help="Its root mean square.")
@click.option("--stretch", type=float, help="brushed: length of a groove, in its width.")
@click.option("--thickness", type=float, help="woven: of a yarn, in its width.")
@click.option(
    "--facets",
    multiple=True,
    default=["Au"],
    show_default=True,
    metavar="MATERIAL",
    help="A metal, paint:R,G,B or plastic:R,G,B; for warp and weft give two.",
)
@click.option("--facet-alpha", default=0.2, show_default=True, help="Roughness of the facets.")
@click.option("--specimen", default=0, show_default=True, help="Seed of the surface.")
@click.option("--cells", metavar="N,N,N", help="Of theta_h, theta_d, phi_d; phi_h before them.")
@click.option("--error", default=0.05, show_default=True, help="Relative standard error wanted.")
@click.option("--spp", default=16384, show_default=True, help="Samples a cell at most.")
@click.option("--seed", default=0, show_default=True, help="Seed of the samples.")
@click.option("-o", "--output", type=click.Path(path_type=Path), help="Default: GEOMETRY.npz.")
@output_options
def measure(
    geometry,
    slope,
    stretch,
    thickness,
    facets,
    facet_alpha,
    specimen,
    cells,
    error,
    spp,
    seed,
    output,
    console,
):
    """Measure the BRDF of a surface by tracing paths through its microgeometry.

    A virtual goniometer. It writes a table with a standard error for every value. The defaults
    measure rough gold, in about a minute. Ctrl-C ends it early, with larger errors.
    """
    from brdfkit import measuring
    from brdfkit.formats import save
    from brdfkit.goniometer import measure as measure_surface

    output = measuring.measurement_file(output or Path(f"{geometry}.npz"))
    parameters = {"slope": slope, "stretch": stretch, "thickness": thickness, "seed": specimen}
    surface = measuring.surface(geometry, **parameters)
    made_of, shape = measuring.facets(facets, facet_alpha), measuring.cells(cells)
    context = click.get_current_context()
    notes = {"command": measuring.command(context.params)}
    with console.progress(f"measure {geometry}") as progress:
        found = measure_surface(
            surface, made_of, shape, error, spp, seed, output.stem, notes, progress
        )
    save(found, output)
    with console.progress("audit"):
        audit = found.audit()
    console.audit(audit, [output])
    if "interrupted" in found.info:
        say(f"interrupted; measured with {found.info['interrupted']}.")
        context.exit(130)


@main.command()
@click.argument("file")
@click.option("-m", "--model", "names", multiple=True, help="A model; repeat it. Default: all.")
@click.option("--loss", default="log", show_default=True, help="cosine, log, cbrt, plain.")
@click.option("--robust", help="Weigh outliers down: bisquare, huber, cauchy ...")
@click.option("-o", "--output", type=click.Path(path_type=Path), help="Folder for the results.")
@click.option("--render", "rendered", is_flag=True, help="Path-trace the measurement and the fits.")
@click.option("--max-angle", default=80.0, show_default=True, help="Use angles below [degrees].")
@render_options
@output_options
def fit(file, names, loss, robust, output, rendered, max_angle, spp, size, seed, console):
    """Fit models to a measured FILE, or to a material of brdfkit's."""
    from brdfkit import registry
    from brdfkit.comparing import compare
    from brdfkit.fitting import fit as fit_model
    from brdfkit.formats import save
    from brdfkit.targets import fit_file, measured, results

    names = list(dict.fromkeys(names or registry.models()))
    for name in names:
        registry.model(name)
    with console.progress(f"read {file}"):
        material = measured(file)
    if output is None and rendered:
        output = Path(material.name)

    fits, psnr, interrupted = [], {}, False
    with results(output):
        try:
            for number, name in enumerate(names, 1):
                with console.progress(f"fit {name} ({number} of {len(names)})") as progress:
                    found = fit_model(
                        name,
                        material,
                        loss,
                        robust=robust,
                        max_angle=max_angle,
                        seed=seed,
                        progress=progress,
                    )
                if output is not None:
                    save(found, fit_file(output, found))
                fits.append(found)
        except KeyboardInterrupt:
            if not fits:
                raise
            say(f"interrupted; {len(fits)} of {len(names)} fits are finished.")
            interrupted = True

        fits.sort(key=lambda f: f.loss)
        written = [fit_file(output, f) for f in fits] if output else []
        if rendered and not interrupted:
            picture = _render([material, *fits], output / "render.exr", spp, size, seed, console)
            psnr = picture.psnr()
            written += [output / "render.exr", output / "render.png"]
    with console.progress("compare"):
        comparison = compare(material, fits, max_angle)
    console.fits(material, fits, comparison, psnr, written)
    if interrupted:
        click.get_current_context().exit(130)


@main.command()
@click.argument("things", nargs=-1, required=True, metavar="FIT|NAME|FILE|SCENE.xml...")
@click.option(
    "-o",
    "--output",
    type=click.Path(path_type=Path),
    help="Picture to write, .exr (with a .png beside it) or .png. Default: NAME.png.",
)
@values_option
@render_options
@output_options
def render(things, output, values, spp, size, seed, console):
    """Path-trace fits, models, measured files or a Mitsuba scene.

    Several are rendered side by side; the first is the reference of the differences. A scene is
    rendered alone, in its own size.
    """
    from brdfkit.rendering import render_scene
    from brdfkit.targets import material, picture_file

    scenes = [t for t in things if t.lower().endswith(".xml")]
    if scenes:
        if len(things) > 1 or values:
            raise BrdfkitError("A scene is rendered alone and as it is: name one SCENE.xml.")
        output = picture_file(output or Path(scenes[0]).with_suffix(".png").name)
        with console.progress("render") as progress:
            picture = render_scene(scenes[0], spp=spp, seed=seed, progress=progress)
        picture.write(output)
    else:
        found = [material(thing, values) for thing in things]
        output = picture_file(output or f"{found[0].name}.png")
        picture = _render(found, output, spp, size, seed, console)
    console.rendering(picture, output)


@main.command()
@click.argument("things", nargs=-1, required=True, metavar="NAME|FILE.py|FIT|FILE...")
@values_option
@output_options
def check(things, values, console):
    """Check that models sample, conserve energy and differentiate."""
    from brdfkit.checks import check as check_thing
    from brdfkit.targets import to_check

    reports = []
    for thing in [t for name in things for t in to_check(name, values)]:
        with console.progress(f"check {thing.name}") as progress:
            reports.append(check_thing(thing, progress=progress))
    console.reports(reports)
    click.get_current_context().exit(0 if all(reports) else 1)


@main.command()
@click.argument("thing", metavar="FILE|NAME|FIT")
@click.argument("output", type=click.Path(path_type=Path))
@values_option
@output_options
def convert(thing, output, values, console):
    """Write a material in the file format of OUTPUT's suffix.

    Tells what that format cannot hold. A model or a fit is evaluated over the hemispheres.
    """
    from brdfkit.converting import convert as convert_thing
    from brdfkit.targets import material, other_file

    output = other_file(output, thing)
    with console.progress(f"convert {thing}"):
        done = convert_thing(material(thing, values), output)
    console.conversion(done)


def _render(things, output, spp, size, seed, console):
    from brdfkit.rendering import render as render_things

    with console.progress("render") as progress:
        picture = render_things(things, spp=spp, size=size, seed=seed, progress=progress)
    picture.write(output)
    return picture
