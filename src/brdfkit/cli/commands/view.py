"""`brdfkit view`: shows a volume or a material interactively in the browser."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import click

from brdfkit.cli.console import Console
from brdfkit.cli.options import mend_options, output_option, writing_options
from brdfkit.core.errors import BrdfkitError


@click.command()
@click.argument("thing", required=False, metavar="[VOLUME|MATERIAL]")
@click.argument("models", nargs=-1, metavar="[MODEL]...")
@output_option("Picture to write instead of showing a page: .png, or .exr with a .png beside it.")
@click.option(
    "--port", type=click.IntRange(0, 65535), default=0, help="Port of the page; 0 is any."
)
@click.option("--no-browser", is_flag=True, help="Print the address, and open no browser.")
@click.option(
    "--downsample", type=click.IntRange(1), metavar="N", help="For a volume: make N³ voxels one."
)
@click.option(
    "--labels/--no-labels",
    default=None,
    help="Treat a volume's values as labels, or as densities; by default the file decides.",
)
@click.option("--state", metavar="JSON", help="Settings to begin with, as the page copies them.")
@click.option("--size", default="512x512", show_default=True, help="Size of the written picture.")
@click.option("--spp", type=click.IntRange(1), default=64, help="Samples of the written picture.")
@mend_options
@writing_options
def view(
    thing: str | None,
    models: tuple[str, ...],
    output: Path | None,
    port: int,
    no_browser: bool,
    downsample: int | None,
    labels: bool | None,
    state: str | None,
    size: str,
    spp: int,
    mends: dict[str, bool],
    console: Console,
) -> None:
    """Show a volume or a material interactively in the browser.

    VOLUME is a file or folder of a scan, or the name of a synthetic volume such as smoke. The page
    orbits it, edits its transfer function, exchanges renderers, light and tone mapping, and shows
    slices.

    MATERIAL is a measured file or name such as car_paint. The page shows it left and the first
    MODEL (ggx, or a sum such as ggx+ward) right of a wipe, with a slider for each parameter, and
    fits the model. A model or the JSON of a fit is shown alone.

    Files can be dropped on the page. Without an argument it is empty, and lists what brdfkit knows.

    Ctrl-C ends it. The page is served to this computer alone; over SSH, forward the port that is
    printed.
    """
    given = {"downsample": downsample, "labels": labels}
    settings = {name: value for name, value in given.items() if value is not None}
    changes = _parse_state(state) | {f"mend.{name}": True for name in mends}

    def make_application() -> Any:
        """Read the volume or the material, and return the view of it."""
        from brdfkit.cli.arguments import refuse_mends
        from brdfkit.viewing.choosing import is_volume, make_application

        if mends and is_volume(thing):
            refuse_mends(str(thing), "a volume", mends)
        with console.progress(f"read {thing}" if thing else "start"):
            return make_application(thing, models, changes, **settings)

    if output is not None and thing is None:
        raise BrdfkitError("--output draws a volume or a material: name one.")
    if output is None:
        _show_page(make_application, port, no_browser)
    else:
        known = labels is not None
        _write_picture(make_application, known, output, _parse_size(size), spp, console)


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
    except (ValueError, RecursionError) as error:
        raise BrdfkitError(f"--state is no JSON ({error}); copy it from the page.") from None
    if not isinstance(changes, dict):
        raise BrdfkitError(
            '--state should be settings by name, such as {"renderer": "isosurface"}.'
        )
    return changes


def _parse_size(size: str) -> tuple[int, int]:
    """Return the numbers of --size."""
    try:
        width, height = map(int, size.lower().split("x"))
    except ValueError:
        width = height = 0
    if min(width, height) < 1:
        raise BrdfkitError(f"--size {size:.40} should be width and height, as 640x480.")
    return width, height


def _write_picture(
    make_application: Callable[[], Any],
    labels_are_known: bool,
    output: Path,
    size: tuple[int, int],
    spp: int,
    console: Console,
) -> None:
    """Render the picture of a state, and write it."""
    from brdfkit.cli.arguments import check_picture_path
    from brdfkit.cli.picture_output import write_result
    from brdfkit.cli.volume_render import warn_of_labels
    from brdfkit.viewing.picture_files import render_state
    from brdfkit.viewing.volumes.application import VolumeApplication

    path = check_picture_path(output)
    application = make_application()
    if not labels_are_known and isinstance(application, VolumeApplication):
        warn_of_labels(application.volume)
    with console.progress("render") as progress:
        first = application.first_state()
        picture = render_state(application, first, size, spp, progress=progress)
    write_result(picture, path, picture.tone_mapping, console)


def _show_page(make_application: Callable[[], Any], port: int, no_browser: bool) -> None:
    """Serve the page until Ctrl-C, and open it in the browser."""
    from brdfkit.viewing import server
    from brdfkit.viewing.render_thread import is_rendering

    server.require_server()
    try:
        with server.open_socket(port) as listening:  # before the volume, which takes longer
            _serve_page(listening, make_application(), no_browser)
    except KeyboardInterrupt:
        if is_rendering():
            _exit_at_once()
        raise


def _serve_page(listening: Any, first: Any, no_browser: bool) -> None:
    """Serve the view `first` to the first page, and views of the same thing to others."""
    import time

    from brdfkit.viewing import server

    waiting = [first]

    def make_application() -> Any:
        try:
            return waiting.pop()
        except IndexError:
            return first.again()

    with server.serve(make_application, listening) as address:
        opened = not no_browser and _open_browser(address)
        click.echo(_describe_page(first.name, address, opened))
        while True:  # until Ctrl-C, which takes effect after a step if another thread receives it
            time.sleep(0.25)


def _exit_at_once() -> None:
    """End the program without its clean-up, which would wait for kernels that run, or crash."""
    import os

    from brdfkit.cli.errors import print_message
    from brdfkit.core.interrupts import find_exit_status
    from brdfkit.viewing.temporary_folders import delete_folders

    delete_folders()  # a long answer may still read them
    print_message("interrupted.")
    os._exit(find_exit_status())


def _describe_page(name: str, address: str, opened: bool) -> str:
    """Return the sentence that says where the page is."""
    import os
    from urllib.parse import urlsplit

    if opened:
        return f"{name} is shown at {address} until Ctrl-C."
    if "SSH_CONNECTION" in os.environ:
        port = urlsplit(address).port
        here = os.environ["SSH_CONNECTION"].split()[2:3] or ["HOST"]
        forward = f"ssh -L {port}:127.0.0.1:{port} {here[0]}"
        return f"{name}: forward its port by '{forward}', and open {address} (until Ctrl-C)."
    return f"{name}: open {address} in a browser (until Ctrl-C)."


def _open_browser(address: str) -> bool:
    """Open the page in the user's browser; return whether there is one with a window."""
    import os
    import sys
    import webbrowser

    windows = sys.platform in ("win32", "darwin") or {"DISPLAY", "WAYLAND_DISPLAY"} & set(
        os.environ
    )
    if not windows or "SSH_CONNECTION" in os.environ:
        return False  # `webbrowser` would open one of text in this terminal
    try:
        return webbrowser.open(address)
    except webbrowser.Error:
        return False
