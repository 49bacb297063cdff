"""`brdfkit data`: lists public measurements and environment maps, and downloads the former."""

from dataclasses import asdict, fields

import click

from brdfkit.cli.options import output_options


@click.group(invoke_without_command=True)
@output_options
@click.pass_context
def data(context, console):
    """List public data, or download measurements.

    \b
    brdfkit data                                the collections, of maps too
    brdfkit data list merl                      the materials of one
    brdfkit data get merl/gold-metallic-paint   download a material
    brdfkit fit merl/gold-metallic-paint        use it by its name

    Downloads are kept in your cache folder. Only `brdfkit data get` downloads anything.
    """
    from brdfkit.core.catalogue import list_map_collections as map_collections
    from brdfkit.materials.collections.public import list_collections

    if context.invoked_subcommand is None:
        _print_all(list_collections(), map_collections(), console)


@data.command("list")
@click.argument("collection")
@output_options
def data_list(collection, console):
    """List the materials of a COLLECTION; of one of maps, its page and terms."""
    from brdfkit.core import catalogue
    from brdfkit.materials.collections import public

    maps = catalogue.list_map_collections().get(collection)
    if maps is None:
        _print_collection(public.find_collection(collection), console)
    elif console.as_json:
        console.json(asdict(maps))
    else:
        console.out.print(str(maps))


@data.command("get")
@click.argument("names", nargs=-1, required=True, metavar="NAME...")
@output_options
def data_get(names, console):
    """Download materials.

    A NAME has its collection before it, as in merl/gold-metallic-paint. Checksums are verified. An
    interrupted download goes on where it stopped, unless the file is part of an archive (merl).
    """
    from brdfkit.materials.collections.downloading import download
    from brdfkit.materials.collections.public import find_collection

    collections = {c.name: c for c in map(find_collection, names)}
    files = {}
    for name in names:
        with console.progress(f"download {name}") as progress:
            files[name] = download(name, progress)
    _print_files(files, collections.values(), console)


def _print_all(collections, map_collections, console):
    """Print what comes with brdfkit, and the public collections."""
    from brdfkit.materials.collections.public import cache_folder

    if console.as_json:
        maps = {name: asdict(c) for name, c in map_collections.items()}
        found = {name: _record(c) for name, c in collections.items()}
        console.json(found | {"environment maps": maps})
        return
    _print_collections(collections, console)
    console.out.print("The materials of a collection: brdfkit data list NAME")
    console.out.print(f"Downloaded files lie in {cache_folder()}")
    _print_map_collections(map_collections, console)
    console.out.print("Fetch a map from its page, and look at it: brdfkit info MAP.hdr")


def _print_collections(collections, console):
    """Print the materials that come with brdfkit, and the public collections."""
    from brdfkit.core.catalogue import list_materials

    columns = "collection", "what it is", ">here", ">to download", "licence"
    licence = next(iter(list_materials().values())).licence
    rows = [("brdfkit's own", ", ".join(list_materials()), str(len(list_materials())), "", licence)]
    for name, c in collections.items():
        here, download = len(c.files_on_disk()), sum(bool(f.url) for f in c.files.values())
        rows.append((name, c.title, str(here), str(download or "by hand"), c.licence))
    console.table(columns, rows)


def _print_map_collections(collections, console):
    """Print the environment maps that come with brdfkit, and where there are others."""
    from brdfkit.core.catalogue import list_environments

    licence = next(iter(list_environments().values())).licence
    rows = [("brdfkit's own", ", ".join(list_environments()), "--envmap NAME", licence)]
    rows += [(name, c.title, c.page, c.licence) for name, c in collections.items()]
    console.table(("environment maps", "what they are", "where", "licence"), rows)


def _print_collection(collection, console):
    """Print the materials of a collection."""
    if console.as_json:
        console.json(_record(collection))
        return
    files, here = collection.files, collection.files_on_disk()
    rows = []
    for name in sorted({*files, *here}):
        size = files[name].bytes if name in files else here[name].stat().st_size
        state = "here" if name in here else "to download" if files[name].url else "by hand"
        rows.append((name, f"{size / 1e6:.1f}" if size else "", state))
    if rows:
        console.table(["material", ">size [MB]", ""], rows)
    console.out.print(str(collection))
    if not any(listed.url for listed in files.values()):
        console.out.print(f"To use one, {collection.by_hand()}.")


def _print_files(files, collections, console):
    """Print where the downloaded files are, and the terms of their publishers."""
    if console.as_json:
        console.json({"files": files, "terms": {c.name: c.terms for c in collections}})
        return
    for name, file in files.items():
        console.out.print(f"{name}: {file}")
    for collection in collections:
        console.out.print(str(collection))


def _record(collection):
    """A collection for JSON, with the place of each file here, or where to get it."""
    here = collection.files_on_disk()
    files = {
        name: {"file": listed.file, "bytes": listed.bytes or None, "url": listed.url or None}
        for name, listed in collection.files.items()
    }
    for name, file in here.items():
        files.setdefault(name, {"file": file.name})["path"] = file
    texts = {f.name: getattr(collection, f.name) for f in fields(collection) if f.name != "files"}
    return {**texts, "folder": collection.folder, "files": files}
