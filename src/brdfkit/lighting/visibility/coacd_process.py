"""Cuts the mesh in a file by coacd, as a process of its own, which Ctrl-C ends at once.

    python coacd_process.py mesh.npz parts.npz SETTINGS

SETTINGS: those of `coacd.run_coacd`, as JSON. Native code hears no Ctrl-C before it is done, after
minutes, and takes the whole process with it where it fails.
"""

import json
import sys

import numpy as np


def cut(mesh, parts, settings):
    """Read `mesh`, and write the corners of all parts, and after how many of them each ends."""
    import coacd

    coacd.set_log_level("off")
    with np.load(mesh) as stored:
        given = coacd.Mesh(stored["points"], stored["faces"])
    corners = [found for found, _ in coacd.run_coacd(given, **json.loads(settings))]
    ends = np.cumsum([len(part) for part in corners])
    np.savez_compressed(parts, points=np.concatenate(corners), ends=ends)


if __name__ == "__main__":
    cut(*sys.argv[1:])
