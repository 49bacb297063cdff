"""`brdfkit data`: lists public measurements and environment maps, and downloads measurements."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import asdict, fields
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from brdfkit.cli.console import Console
from brdfkit.cli.options import output_options

if TYPE_CHECKING:
    from brdfkit.materials.collections.public import Collection, ListedFile


@click.group(invoke_without_command=True)
@output_options
@click.pass_context
def data(context: click.Context, console: Console) -> None:
    """List public data, or download measurements.

    \b
    brdfkit data                                list the collections
    brdfkit data list merl                      list the materials of one
    brdfkit data get merl/gold-metallic-paint   download a material
    brdfkit fit merl/gold-metallic-paint        use it by its name
    brdfkit data get captures/cat               download photographs of an object

    Downloaded files are kept in your cache folder. Only `brdfkit data get` uses the network.
    """
    from brdfkit.core.catalogue import list_map_collections
    from brdfkit.materials.collections.public import list_collections

    if context.invoked_subcommand is None:
        _print_public_data(list_collections(), list_map_collections(), console)


@data.command("list")
@click.argument("collection")
@output_options
def data_list(collection: str, console: Console) -> None:
    """List the materials of a COLLECTION.

    For a collection of environment maps, the command prints its web page and its terms.
    """
    from brdfkit.core import catalogue
    from brdfkit.materials.collections import public

    maps = catalogue.list_map_collections().get(collection)
    if maps is None:
        _print_collection(public.find_collection(collection), console)
    elif console.as_json:
        console.print_json(asdict(maps))
    else:
        console.output.print(str(maps))


@data.command("get")
@click.argument("names", nargs=-1, required=True, metavar="NAME...")
@output_options
def data_get(names: tuple[str, ...], console: Console) -> None:
    """Download materials.

    A NAME begins with its collection, as in merl/gold-metallic-paint. Checksums are verified. An
    interrupted download continues where it stopped, unless the file is part of an archive (merl).
    """
    from brdfkit.materials.collections.downloading import download
    from brdfkit.materials.collections.public import find_collection

    collections = {c.name: c for c in map(find_collection, names)}
    files = {}
    for name in names:
        with console.progress(f"download {name}") as bar:
            progress: Any = bar  # its total may be None, for an unknown size
            files[name] = download(name, progress)
    _print_files(files, collections.values(), console)


def _print_public_data(
    collections: Mapping[str, Collection], map_collections: Mapping[str, Any], console: Console
) -> None:
    """Print the materials and maps that come with brdfkit, and the public collections."""
    from brdfkit.materials.collections.public import find_cache_folder

    if console.as_json:
        maps = {name: asdict(c) for name, c in map_collections.items()}
        records = {name: _make_collection_record(c) for name, c in collections.items()}
        console.print_json(records | {"environment maps": maps})
        return
    _print_collections(collections, console)
    console.output.print("The materials of a collection: brdfkit data list NAME")
    console.output.print(f"Downloaded files lie in {find_cache_folder()}")
    _print_map_collections(map_collections, console)
    console.output.print("Download a map from its page, and look at it: brdfkit info MAP.hdr")


def _print_collections(collections: Mapping[str, Collection], console: Console) -> None:
    """Print the materials that come with brdfkit, and the public collections."""
    from brdfkit.core.catalogue import list_materials

    columns = "collection", "what it is", ">here", ">to download", "licence"
    licence = next(iter(list_materials().values())).licence
    rows = [("brdfkit's own", ", ".join(list_materials()), str(len(list_materials())), "", licence)]
    for name, c in collections.items():
        here = len(c.list_files_on_disk()) + sum(map(_is_here, c.folders.values()))
        download = len(c.folders) or sum(bool(f.url) for f in c.files.values())
        rows.append((name, c.title, str(here), str(download or "by hand"), c.licence))
    console.print_table(columns, rows)


def _print_map_collections(collections: Mapping[str, Any], console: Console) -> None:
    """Print the environment maps that come with brdfkit, and collections of others."""
    from brdfkit.core.catalogue import list_environments

    licence = next(iter(list_environments().values())).licence
    rows = [("brdfkit's own", ", ".join(list_environments()), "--envmap NAME", licence)]
    rows += [(name, c.title, c.page, c.licence) for name, c in collections.items()]
    console.print_table(("environment maps", "what they are", "where", "licence"), rows)


def _print_collection(collection: Collection, console: Console) -> None:
    """Print the materials of a collection."""
    if console.as_json:
        console.print_json(_make_collection_record(collection))
        return
    files, here = collection.files, collection.list_files_on_disk()
    rows = []
    for name, parts in collection.folders.items():
        size = sum(part.bytes for part in parts)
        rows.append((name, f"{size / 1e6:.1f}", "here" if _is_here(parts) else "to download"))
        files = {key: file for key, file in files.items() if file not in parts}
    for name in sorted({*files, *here}):
        size = files[name].bytes if name in files else here[name].stat().st_size
        state = "here" if name in here else "to download" if files[name].url else "by hand"
        rows.append((name, f"{size / 1e6:.1f}" if size else "", state))
    if rows:
        console.print_table(
            ["photographs" if collection.folders else "material", ">size [MB]", ""], rows
        )
    console.output.print(str(collection))
    if not any(listed.url for listed in collection.files.values()):
        console.output.print(f"To use one, {collection.explain_manual_fetch()}.")


def _is_here(files: Iterable[ListedFile]) -> bool:
    """Return whether all files of a folder of photographs are on this disk."""
    return all(file.path.is_file() for file in files)


def _print_files(
    files: Mapping[str, Path], collections: Iterable[Collection], console: Console
) -> None:
    """Print the paths of downloaded files, and the terms of their publishers."""
    if console.as_json:
        console.print_json({"files": files, "terms": {c.name: c.terms for c in collections}})
        return
    for name, file in files.items():
        console.output.print(f"{name}: {file}")
    for collection in collections:
        console.output.print(str(collection))


def _make_collection_record(collection: Collection) -> dict[str, Any]:
    """Return a collection as a dictionary, with the path or address of each file, for --json."""
    here = collection.list_files_on_disk()
    files: dict[str, dict[str, Any]] = {
        name: {"file": listed.file, "bytes": listed.bytes or None, "url": listed.url or None}
        for name, listed in collection.files.items()
    }
    for name, file in here.items():
        files.setdefault(name, {"file": file.name})["path"] = file
    texts = {f.name: getattr(collection, f.name) for f in fields(collection) if f.name != "files"}
    return {**texts, "folder": collection.folder, "files": files}
