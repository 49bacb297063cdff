"""`brdfkit view`: shows a volume interactively in the browser."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import click

from brdfkit.cli.console import Console
from brdfkit.cli.options import writing_options
from brdfkit.core.errors import BrdfkitError


@click.command()
@click.argument("volume", metavar="VOLUME")
@click.option(
    "--port", type=click.IntRange(0, 65535), default=0, help="Port of the page; 0 is any."
)
@click.option("--no-browser", is_flag=True, help="Print the address, and open no browser.")
@click.option("--downsample", type=click.IntRange(1), metavar="N", help="Make N³ voxels one.")
@click.option("--state", metavar="JSON", help="Settings to begin with, as the page copies them.")
@click.option("--save", type=click.Path(path_type=Path), help="Write this picture, show no page.")
@click.option("--size", default="512x512", show_default=True, help="Size of the saved picture.")
@click.option("--spp", type=click.IntRange(1), default=64, help="Samples of the saved picture.")
@writing_options
def view(
    volume: str,
    port: int,
    no_browser: bool,
    downsample: int | None,
    state: str | None,
    save: Path | None,
    size: str,
    spp: int,
    console: Console,
) -> None:
    """Show a VOLUME interactively in the browser, until Ctrl-C.

    VOLUME is a file or folder of a scan, or the name of a synthetic volume such as smoke. The page
    orbits it, edits its transfer function, exchanges renderers, light and tone mapping, and shows
    slices. It is served to this computer alone; over SSH, forward the port that is printed.
    """
    from brdfkit.viewing.volumes.opening import load_within_memory

    changes = _parse_state(state)
    settings = {} if downsample is None else {"downsample": downsample}
    if save is not None:
        _save_picture(load_within_memory(volume, **settings), changes, save, size, spp, console)
        return
    from brdfkit.viewing import server
    from brdfkit.viewing.volumes.application import VolumeApplication

    server.require_server()
    listening = server.open_socket(port)
    loaded = load_within_memory(volume, **settings)

    def make_application() -> VolumeApplication:
        return VolumeApplication(loaded, volume, changes)

    make_application()  # an impossible state is an error before the page opens

    def announce(address: str) -> None:
        click.echo(f"{loaded.name}: {address}  (Ctrl-C ends it)")
        if not no_browser:
            _open_browser(address)

    server.serve(make_application, listening, announce)


def _parse_state(state: str | None) -> dict[str, Any]:
    """Return the settings of --state, a JSON dictionary or the name of a file of one."""
    import json

    if state is None:
        return {}
    text = state
    if not state.lstrip().startswith("{"):
        from brdfkit.core.files import read_bytes

        text = read_bytes(Path(state)).decode("utf-8", "replace")
    try:
        changes = json.loads(text)
    except ValueError as error:
        raise BrdfkitError(f"--state is no JSON ({error}); copy it from the page.") from None
    if not isinstance(changes, dict):
        raise BrdfkitError(
            '--state should be settings by name, such as {"renderer": "isosurface"}.'
        )
    return changes


def _save_picture(
    volume: Any, changes: dict[str, Any], path: Path, size: str, spp: int, console: Console
) -> None:
    """Render the picture of a state, and write it."""
    from brdfkit.viewing import render_view

    try:
        width, height = (int(side) for side in size.lower().split("x"))
    except ValueError:
        raise BrdfkitError(f"--size {size} should be width and height, as 640x480.") from None
    picture = render_view(volume, changes, size=(width, height), spp=spp)
    picture.write(path)
    console.print_written([path])


def _open_browser(address: str) -> None:
    """Open the page in the user's browser, if there is one."""
    import webbrowser

    try:
        opened = webbrowser.open(address)
    except webbrowser.Error:
        opened = False
    if not opened:
        click.echo("No browser was found: open the address in one.", err=True)
