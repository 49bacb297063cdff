"""Times of `brdfkit view`: the first picture, changed sliders, and pictures a second in turning.

python benchmarks/view_times.py [SIDE]
python benchmarks/view_times.py MATERIAL [MODEL ...]

The volume is `smoke` with SIDE³ voxels, by default 128³. Each picture is rendered, tone-mapped and
encoded as the page gets it, in this process; only the way to the browser is left out. Of materials,
the time of the first picture counts from the start of Python. Other programs may run beside this
one: so the time of all cores together [s of the processor] stands beside that on the clock.
"""

import os
import sys
import time

import numpy as np

import brdfkit as bk
from brdfkit.viewing.choosing import make_application
from brdfkit.viewing.session import Session
from brdfkit.viewing.volumes.application import VolumeApplication
from brdfkit.viewing.volumes.volume_controls import LABELS

SIZES = (256, 512)  # side of the pictures [pixels]
PICTURES = 24  # that are timed while the camera turns
SLIDERS = {"level": 0.35, "density": 2.0, "background": "#101010", "clip": [[0, 0, 0], [1, 1, 0.7]]}


def show(session: Session, changes: dict, moving: bool) -> float:
    """Change the state, render until a picture is sent, and return the time it took [s]."""
    start = time.perf_counter()
    session.handle({"type": "set", "changes": changes, "moving": moving})
    while True:
        for message, _ in session.work():
            if message["type"] == "picture":
                session.handle({"type": "shown", "number": message["number"]})
                return time.perf_counter() - start


def show_materials(material: str, models: list[str]) -> None:
    """Print the times of the first picture, and a line for each model and size."""
    session = Session(make_application(material, models))
    session.handle({"type": "hello", "width": 960, "height": 640, "state": None})
    show(session, {}, False)
    print(f"first picture of 960 × 640 after {since_start()}")
    while not session.previews:
        session.work()
        session.handle({"type": "shown", "number": session.number})
    print(f"the first one without noise after {since_start()}")
    for model in models:
        for width, height in ((256, 256), (960, 640)):
            session.handle({"type": "resize", "width": width, "height": height})
            scale = 1.0 if width == height else 0.5  # as the page does while something moves
            show(session, {"model": model, "view.moving_scale": scale}, True)
            names = [name for name in session.state if name.startswith("model.")]
            slider = next(name for name in reversed(names) if is_number(session.state[name]))
            for name, values in {
                slider: np.linspace(0.1, 0.5, PICTURES),
                "light.turn": np.arange(PICTURES) * 5.0,
            }.items():
                show(session, {name: 0.07}, True)
                cores = time.process_time()
                times = [show(session, {name: float(value)}, True) for value in values]
                cores = (time.process_time() - cores) / PICTURES
                print(
                    f"{model:12} {width:4}×{height} × {scale:g}  {name:28} "
                    f"{1e3 * min(times):4.0f} ms at least, {1e3 * np.median(times):4.0f} ms in the "
                    f"median ({1e3 * cores:.0f} ms)"
                )


def show_volume(side: int) -> None:
    """Print a line for each renderer and size."""
    start = time.perf_counter()
    volume = bk.volumes.load("smoke", size=side)
    loaded = time.perf_counter() - start
    application = VolumeApplication(volume, "smoke")
    made = time.perf_counter() - start
    session = Session(application)
    session.handle({"type": "hello", "width": 512, "height": 512, "state": None})
    first = made + show(session, {"show.box": False}, False)
    print(f"{side}³ voxels: loaded in {loaded:.1f} s, first picture of 512² after {first:.1f} s")
    for renderer in LABELS:
        for size in SIZES:
            session.handle({"type": "resize", "width": size, "height": size})
            show(session, {"renderer": renderer, "view.moving_scale": 1.0}, True)
            show(session, {"camera.azimuth": 1.0}, True)
            times = [show(session, {"camera.azimuth": 3.0 * k}, True) for k in range(PICTURES)]
            changes = [show(session, {name: value}, True) for name, value in SLIDERS.items()]
            changes.append(show(session, {"transfer.points": raised(session)}, True))
            print(
                f"{renderer:20} {size}²: {1 / np.median(times):5.1f} pictures/s, "
                f"a changed slider or curve {1e3 * max(changes):4.0f} ms at most"
            )


def since_start() -> str:
    """Return the time since Python's start, and that of all cores, in words; on Linux."""
    started = os.stat(f"/proc/{os.getpid()}").st_ctime
    return f"{time.time() - started:.1f} s ({time.process_time():.1f} s)"


def is_number(value: object) -> bool:
    """Return whether a setting is a number."""
    return isinstance(value, float)


def raised(session: Session) -> list:
    """Return the control points of the transfer function with A changed in the middle."""
    points = [list(point) for point in session.state["transfer.points"]]
    middle = points[len(points) // 2]
    middle[2] = 1 - middle[2]
    return points


if __name__ == "__main__":
    given = sys.argv[1:] or ["128"]
    if given[0].isdigit():
        show_volume(int(given[0]))
    else:
        show_materials(given[0], given[1:] or ["ggx"])
