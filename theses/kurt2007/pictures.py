"""Draws rendered pictures beside each other, and their differences, as one figure."""

from contextlib import contextmanager
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np

from brdfkit.core.colours import luminance, to_srgb
from brdfkit.core.files import read_bytes
from brdfkit.rendering import preview, render
from brdfkit.theses.drawing import make_figure

SIDE, SPP = 112, 256  # pixels, and samples per pixel, of pictures that are shown
RAYS = 16  # rays per pixel of pictures without noise
BRIGHT, WHITE = 99, 0.8  # percentile of the first picture that is shown at this share of white
FULL = 0.25  # of white: a difference that is shown in full colour
MEANS = (
    "Differences of luminance: red is brighter than the first picture, blue darker, in full colour "
    f"from {FULL:.0%} of white."
)


def render_pictures(materials, scene="ball", environment=None, size=SIDE, spp=SPP):
    """Return the `Rendering` of materials by name, path-traced with the same samples.

    Raises `KeyboardInterrupt` where Ctrl-C ends it early, so that no verdict hangs on noise.
    """
    pictures = render(
        list(materials.items()), spp=spp, size=size, scene=scene, environment=environment
    )
    if pictures.spp < spp:
        raise KeyboardInterrupt
    return pictures


def render_without_noise(materials, scene, environment="studio", shadows=False):
    """Return the `Rendering` of materials by name under the light of a map, without noise.

    It contains no light that surfaces reflect to each other. Where a model reflects more light than
    arrives, as Ward-Dür does near the horizon, path-traced pictures have single bright pixels.
    """
    return preview(
        list(materials.items()),
        spp=RAYS,
        size=SIDE,
        scene=scene,
        environment=environment,
        shadows=shadows,
    )


@contextmanager
def unpack_mesh(sources, name):
    """Give the path of a mesh, models/NAME.obj.xz beside the measurements, within a block.

    Where it is missing, it is the scene "knot", which comes with brdfkit.
    """
    packed = sources.find_beside(f"models/{name}.obj.xz")
    if packed is None:
        yield "knot"
        return
    with TemporaryDirectory() as folder:
        plain = Path(folder) / packed.stem
        plain.write_bytes(read_bytes(packed))
        yield str(plain)


def show_rendering(rendering):
    """Return the pictures by name as sRGB, with one exposure."""
    exposure = find_exposure(rendering)
    return {n: to_srgb(np.clip(exposure * p, 0, 1)) for n, p in rendering.pictures.items()}


def show_differences(rendering):
    """Return the differences of the other pictures to the first by name, as coloured pictures."""
    from matplotlib import colormaps

    exposure, colours = find_exposure(rendering), colormaps["RdBu_r"]
    return {
        name: colours(0.5 + exposure * luminance(picture) / (2 * FULL))[..., :3]
        for name, picture in rendering.differences.items()
    }


def find_exposure(rendering):
    """Return the factor that brings the bright part of the material in the first picture to white.

    It is found in the pixels that show the material.
    """
    first = luminance(rendering.pictures[rendering.reference])
    seen = first if rendering.mask is None else first[rendering.mask]
    return WHITE / max(float(np.percentile(seen, BRIGHT)), 1e-9)


def draw_picture_grid(rows, cell=1.0):
    """Draw pictures in rows and columns, each `cell` inches wide; return the figure.

    rows : pairs of a label and a list of cells, each of which is a pair of a title and a picture
        (height, width, 3), or None for an empty place.
    """
    columns = max(len(cells) for _, cells in rows)
    titled = sum(any(c and c[0] for c in cells) for _, cells in rows)
    drawn = make_figure(columns * cell + 0.35, len(rows) * cell + 0.28 * titled)
    drawn.get_layout_engine().set(w_pad=0.01, h_pad=0.01, wspace=0.01, hspace=0.01)
    grid = drawn.subplots(len(rows), columns, squeeze=False)
    for line, (label, cells) in zip(grid, rows, strict=True):
        for place, axes in enumerate(line):
            axes.set(xticks=[], yticks=[])
            axes.spines[:].set_visible(False)
            shown = cells[place] if place < len(cells) else None
            if shown:
                axes.imshow(np.clip(shown[1], 0, 1), interpolation="lanczos")
                axes.set_title(shown[0], size=8, pad=2)
        line[0].set_ylabel(label, size=8)
    return drawn
