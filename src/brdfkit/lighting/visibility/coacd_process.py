"""A program that cuts a mesh by coacd, in a process of its own that Ctrl-C can end at once.

    python coacd_process.py mesh.npz parts.npz SETTINGS

SETTINGS are those of `coacd.run_coacd`, as JSON. Native code reacts to Ctrl-C only when it is done,
after minutes, and takes the whole process with it where it fails.
"""

import json
import sys

import numpy as np


def cut(mesh: str, parts: str, settings: str) -> None:
    """Read the file `mesh`, and write the corners of all parts and the index where each ends."""
    import coacd

    coacd.set_log_level("off")
    with np.load(mesh) as stored:
        whole = coacd.Mesh(stored["points"], stored["faces"])
    corners = [points for points, _ in coacd.run_coacd(whole, **json.loads(settings))]
    ends = np.cumsum([len(part) for part in corners])
    np.savez_compressed(parts, points=np.concatenate(corners), ends=ends)


if __name__ == "__main__":
    cut(*sys.argv[1:])
