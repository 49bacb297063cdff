"""Closes the holes of a piece of a mesh, each by a fan of triangles, unless it is an opening."""

import numpy as np

WIDEST = 0.3  # of a hole over the longest side of the mesh; a wider one may be an opening
COVERED = 0.75  # winding number in the middle of a hole, from which on the mesh is around it


def close_holes(points, faces, mesh):
    """The points and faces of a piece with its holes closed, each from the mean of its corners.

    points, faces : a piece whose triangles all face out.
    mesh : the faces (m, 3) of all pieces, among the same points.

    A wide hole is closed where the mesh covers it, as the body of a teapot covers the foot of its
    spout: in its middle the winding number [Jacobson et al. 2013] is 1, at an opening 1/2. A piece
    comes back as it is where it has an opening, or where two of its holes share a corner.
    """
    loops = _loops(faces)
    if not loops:
        return points, faces
    middles = np.array([points[loop].mean(axis=0) for loop in loops])
    size = np.ptp(points[mesh], axis=(0, 1)).max()
    wide = np.array([np.ptp(points[loop], axis=0).max() > WIDEST * size for loop in loops])
    if wide.any() and _winding_number(points, mesh, middles[wide]).min() < COVERED:
        return points, faces
    fans = [
        [a, b, len(points) + k]
        for k, loop in enumerate(loops)
        for a, b in zip(loop, loop[1:] + loop[:1], strict=True)
    ]
    return np.concatenate([points, middles]), np.concatenate([faces, fans])


def _winding_number(points, faces, at):
    """How often the faces wind around each of the points `at` (n, 3)."""
    import igl

    return igl.winding_number(points, faces, at)


def _loops(faces):
    """The corners around each hole, lists in the order of the triangles that close it.

    Empty where the piece is closed, or two holes share a corner.
    """
    edges = set(map(tuple, np.concatenate([faces[:, [i, (i + 1) % 3]] for i in range(3)]).tolist()))
    border = [(b, a) for a, b in edges if (b, a) not in edges]
    following = dict(border)
    if len(following) < len(border):
        return []
    loops = []
    while following:
        first, corner = following.popitem()
        loop = [first]
        while corner != first:
            loop.append(corner)
            if corner not in following:
                return []
            corner = following.pop(corner)
        loops.append(loop)
    return loops
