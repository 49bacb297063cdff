"""Compares speed and errors of `brdfkit view` with those of VTK, PyVista and K3D, in one run.

    python benchmarks/compare_view_programs.py          # ten minutes on two cores

It writes docs/view_programs.md. PyVista, VTK, K3D and Playwright with a Chromium have to be
installed: `pip install pyvista k3d playwright`. Each program draws in a process of its own, which
this file starts as `python benchmarks/compare_view_programs.py PROGRAM SETTING FOLDER START`, so
that the time until its first picture contains all that it imports.
"""

import json
import subprocess
import sys
import tempfile
import time
from pathlib import Path

from volume_programs.turning import measure_program

SIDE = 128  # voxels along the volume's edges
FROM = [0.3, 1.0, -0.4]  # the direction of the view
PATIENCE = 600  # seconds for a program and a setting


def main() -> None:
    """Measure all programs, and write the page."""
    from volume_programs import speeds_page as page

    with tempfile.TemporaryDirectory() as folder:
        write_volume(Path(folder))
        found = {row: measure(*row, folder) for row in page.ROWS}
    page.write_page(found, SIDE)


def write_volume(folder: Path) -> None:
    """Write smoke as a raw file, and its transfer function, for all programs."""
    import brdfkit as bk
    from brdfkit.rendering.volumes.defaults import choose_transfer_function

    volume = bk.volumes.load("smoke", size=SIDE)
    volume.values.tofile(folder / f"smoke_{SIDE}x{SIDE}x{SIDE}_float32.raw")
    glow = choose_transfer_function(volume, "emission_absorption")
    transfer = {"values": glow.values.tolist(), "rgba": glow.rgba.tolist()}
    transfer |= {"extinction": glow.extinction, "colour": glow.colour}
    entry = {"renderer": "emission_absorption", "labels": False, "transfer": transfer}
    entry |= {"towards": FROM, "half": 3**0.5, "size": [SIDE] * 3}
    (folder / "smoke.json").write_text(json.dumps(entry), encoding="utf-8")


def measure(program: str, setting: str, folder: str) -> dict:
    """Return the times of a program, or the last line of its error."""
    command = [sys.executable, __file__, program, setting, folder, str(time.time())]
    try:
        told = subprocess.run(command, capture_output=True, text=True, timeout=PATIENCE)
    except subprocess.TimeoutExpired:
        return {"error": f"nothing within {PATIENCE} s"}
    lines = told.stdout.strip().splitlines()
    if told.returncode or not lines:
        return {"error": (told.stderr.strip().splitlines() or ["no output"])[-1]}
    print(program, setting, lines[-1], flush=True)
    return json.loads(lines[-1])


if __name__ == "__main__":
    if len(sys.argv) == 1:
        main()
    else:
        print(json.dumps(measure_program(*sys.argv[1:4], float(sys.argv[4]))))
