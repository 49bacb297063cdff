"""Times of `brdfkit view`: the first picture, changed sliders, and pictures a second in turning.

python benchmarks/view_times.py [SIDE]

The volume is `smoke` with SIDE³ voxels, by default 128³. Each picture is rendered, tone-mapped and
encoded as the page gets it, in this process; only the way to the browser is left out.
"""

import sys
import time

import numpy as np

import brdfkit as bk
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


def main() -> None:
    """Print a line for each renderer and size."""
    side = int(sys.argv[1]) if len(sys.argv) > 1 else 128
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


def raised(session: Session) -> list:
    """Return the control points of the transfer function with A changed in the middle."""
    points = [list(point) for point in session.state["transfer.points"]]
    middle = points[len(points) // 2]
    middle[2] = 1 - middle[2]
    return points


if __name__ == "__main__":
    main()
