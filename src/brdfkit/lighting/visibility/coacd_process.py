"""A program that cuts a mesh into convex parts by coacd, so that Ctrl-C can end it at once.

    python coacd_process.py mesh.npz parts.npz SETTINGS

SETTINGS are those of `coacd.run_coacd`, as JSON. In the caller's process, this native code would
ignore Ctrl-C until it is done, after minutes, and a crash would end the caller.
"""

import json
import sys

import numpy as np


def cut_mesh(mesh: str, parts: str, settings: str) -> None:
    """Cut the mesh in the file `mesh` into convex parts, and write them to the file `parts`.

    The file has the corners of all parts, and for each part the index behind its last corner.
    """
    import coacd

    coacd.set_log_level("off")
    with np.load(mesh) as stored:
        whole = coacd.Mesh(stored["points"], stored["faces"])
    corners = [points for points, _ in coacd.run_coacd(whole, **json.loads(settings))]
    ends = np.cumsum([len(part) for part in corners])
    np.savez_compressed(parts, points=np.concatenate(corners), ends=ends)


if __name__ == "__main__":
    cut_mesh(*sys.argv[1:])
