"""Draws a volume in brdfkit's view, VTK, PyVista or K3D while the camera turns, and measures it.

Imports are within functions: what a program imports belongs to the time until its first picture.
"""

import json
import re
import statistics
import subprocess
import sys
import time
from collections.abc import Callable
from functools import partial
from pathlib import Path

SIZES = (256, 512)  # edges of the pictures [pixels]
PICTURES = 12  # of which the median time is taken
LONGEST = 15.0  # seconds, after which fewer pictures have to do
TURN = 3.0  # degrees from one picture to the next
NOTHING = 0.0, 0.0  # seconds, and CPU seconds, that do not count
Draw = Callable[[float], object]  # draws the picture at an azimuth [degrees]
SHOWN = "() => /(\\d+) sample/.exec(document.body.innerText)?.[1] >= 1"  # in the status line
FINISHED = """async (camera) => {
    k3d.setCamera(camera);
    await k3d.getWorld().render(true);
    const gl = k3d.getWorld().renderer.getContext();  // waits until all is drawn
    gl.readPixels(0, 0, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, new Uint8Array(4));
}"""


def measure_program(program: str, setting: str, folder: str, start: float) -> dict:
    """Return (seconds, CPU seconds) until the first picture of 512², and of a picture by size."""
    open_view = {"VTK": open_vtk, "PyVista": open_pyvista, "K3D": open_k3d}.get(program)
    if open_view is None:
        open_view, first = open_brdfkit, open_page(Path(folder))
    else:
        draw, other = open_view(Path(folder), setting, 512)
        draw(0.0)
        first = time.time() - start - other[0], count_cpu_seconds() - other[1]
    found = {"first": first}
    for size in SIZES:
        draw, _ = open_view(Path(folder), setting, size)
        found[str(size)] = measure_turn(draw)
    return found


def measure_turn(draw: Draw) -> tuple[float, float]:
    """Return the median seconds, and the mean CPU seconds, of a picture while the camera turns."""
    draw(-TURN)  # is not counted
    seconds: list[float] = []
    before = count_cpu_seconds()
    while len(seconds) < PICTURES and sum(seconds) < LONGEST:
        start = time.perf_counter()
        draw(TURN * len(seconds))
        seconds.append(time.perf_counter() - start)
    return statistics.median(seconds), (count_cpu_seconds() - before) / len(seconds)


def count_cpu_seconds() -> float:
    """Return the CPU seconds of this process, and of all that it has started and that still run."""
    import psutil

    own = psutil.Process()
    times = [process.cpu_times() for process in (own, *own.children(recursive=True))]
    return sum(spent.user + spent.system for spent in times)


def read_case(folder: Path) -> object:
    """Return the volume as a `Case`, as the conformance set has them."""
    import numpy as np

    from .case import Case

    read = json.loads((folder / "smoke.json").read_text(encoding="utf-8"))
    values = np.fromfile(next(folder.glob("*.raw")), np.float32).reshape(read["size"])

    class Smoke(Case):
        entry, voxels = read, values

    return Smoke("smoke")


def turn_camera(case: object, azimuth: float) -> tuple[list[float], list[float]]:
    """Return the directions towards the volume's centre, and upwards, at an azimuth."""
    import numpy as np

    towards, _, up = case.view_axes
    c, s = np.cos(np.radians(azimuth)), np.sin(np.radians(azimuth))
    turn = np.array([[c, 0, s], [0, 1, 0], [-s, 0, c]])
    return turn @ towards, turn @ up


def open_page(folder: Path) -> tuple[float, float]:
    """Return the seconds, and CPU seconds, from `brdfkit view` to the first picture on its page."""
    from .by_k3d import start_browser

    page = start_browser().new_page(viewport={"width": 900, "height": 640})
    state = json.dumps({"renderer": "emission_absorption", "transfer.preset": "emission"})
    file = str(next(folder.glob("*.raw")))
    command = [sys.executable, "-m", "brdfkit", "view", file, "--no-browser", "--state", state]
    start, before = time.time(), count_cpu_seconds()
    server = subprocess.Popen(command, stdout=subprocess.PIPE, text=True)
    try:
        page.goto(re.search(r"http://\S+", server.stdout.readline())[0])
        page.wait_for_function(SHOWN, timeout=120_000)
        return time.time() - start, count_cpu_seconds() - before
    finally:
        server.terminate()
        page.close()


def open_brdfkit(folder: Path, setting: str, size: int) -> tuple[Draw, tuple[float, float]]:
    """Return a function that renders and encodes pictures as the page of a view gets them."""
    import view_times

    import brdfkit as bk
    from brdfkit.viewing.session import Session
    from brdfkit.viewing.volumes.application import VolumeApplication

    volume = bk.volumes.load(next(folder.glob("*.raw")), spacing=2 / 128)
    first = {"renderer": "emission_absorption", "transfer.preset": "emission"}
    session = Session(VolumeApplication(volume, changes=first | {"view.moving_scale": 1.0}))
    session.handle({"type": "hello", "width": size, "height": size, "state": None})
    moving = setting == "turning"
    return lambda azimuth: view_times.show(session, {"camera.azimuth": azimuth}, moving), NOTHING


def open_vtk(folder: Path, setting: str, size: int) -> tuple[Draw, tuple[float, float]]:
    """Return a function that draws in VTK, and reads the picture back."""
    import numpy as np

    from . import by_vtk

    case = read_case(folder)
    padding = 1 if setting == "careful" else 0
    voxels = np.pad(case.voxels, padding, mode="edge")
    image = by_vtk.make_image_data(voxels, case.spacing, padding)
    window = by_vtk.make_window(by_vtk.make_volume(image, case, setting), case, 0.0, size)
    camera = window.GetRenderers().GetFirstRenderer().GetActiveCamera()
    return partial(draw_vtk, case, camera, lambda: by_vtk.read_picture(window, size)), NOTHING


def open_pyvista(folder: Path, setting: str, size: int) -> tuple[Draw, tuple[float, float]]:
    """Return a function that draws in PyVista, and reads the picture back."""
    from . import by_pyvista

    case = read_case(folder)
    plotter = by_pyvista.make_plotter(case, setting, size)
    plotter.show(auto_close=False)
    take = partial(plotter.screenshot, return_img=True)
    return partial(draw_vtk, case, plotter.camera, lambda: (plotter.render(), take())), NOTHING


def draw_vtk(case: object, camera: object, take: Callable[[], object], azimuth: float) -> object:
    """Turn a camera of VTK's, and take the picture."""
    towards, up = turn_camera(case, azimuth)
    camera.SetPosition(-5.0 * towards)
    camera.SetViewUp(up)
    camera.SetClippingRange(0.1, 10.0)
    return take()


def open_k3d(folder: Path, setting: str, size: int) -> tuple[Draw, tuple[float, float]]:
    """Return a function that draws in K3D in Chromium, and the times that the browser takes."""
    import numpy as np

    from . import by_k3d

    start, before = time.time(), count_cpu_seconds()
    browser = by_k3d.start_browser()
    other = time.time() - start, count_cpu_seconds() - before
    case = read_case(folder)
    plot = by_k3d.make_plot(case, setting, 0)
    distance = case.entry["half"] / np.tan(np.radians(by_k3d.FIELD_OF_VIEW / 2))
    page = browser.new_page(viewport={"width": size, "height": size})
    page.set_content(plot.get_snapshot(additional_js_code="window.k3d = K3DInstance;"))
    page.wait_for_function("window.k3d", timeout=120_000)
    page.evaluate("k3d.setAutoRendering(false)")

    def draw(azimuth: float) -> None:
        towards, up = turn_camera(case, azimuth)
        page.evaluate(FINISHED, [*(-distance * towards).tolist(), 0, 0, 0, *up.tolist()])

    return draw, other
