"""Draws the conformance set in PyVista, by `Plotter.add_volume` with 256 colours and opacities."""

import numpy as np
import pyvista
from matplotlib.colors import ListedColormap

from .by_vtk import aim_camera, make_image_data
from .case import BEHIND, PIXELS

NAME = "PyVista"
COLOURS = 256
SETTINGS = {
    "typed in": "A typed in as the opacity, all else at its defaults",
    "right unit": "opacity 1 - exp(-σ_t d) for `opacity_unit_distance=d`",
    "careful": "so, and interpolated: `actor.prop.interpolation_type = 'linear'`",
}
BLENDING = {"emission_absorption": "composite", "maximum_intensity": "maximum"}


def find_version():
    return pyvista.__version__


def draw_case(case, setting):
    """Return RGB (height, width, 4); the opacity is NaN."""
    if case.renderer == "isosurface" or "gradients" in case.transfer:
        return None  # PyVista leaves isosurfaces to VTK, and has no gradient opacity
    plotter = make_plotter(case, setting, PIXELS)
    shown = plotter.screenshot(return_img=True)[..., :3] / 255
    plotter.close()
    return np.concatenate([shown, np.full((PIXELS, PIXELS, 1), np.nan)], axis=-1)


def make_plotter(case, setting, pixels):
    """Return a plotter that shows a case off the screen."""
    low, high = case.values[[0, -1]]
    at = np.linspace(low, high, COLOURS)
    v, rgb, sigma = case.sample_transfer()
    unit = case.transfer.get("opacity_unit_distance")
    a = np.interp(at, case.values, case.rgba[:, 3])
    if setting != "typed in" and case.renderer == "emission_absorption":
        unit = 1 / sigma.max()
        a = -np.expm1(-np.interp(at, v, sigma) * unit)
    colours = np.stack([np.interp(at, v, column) for column in rgb.T], axis=-1)
    plotter = pyvista.Plotter(off_screen=True, window_size=(pixels, pixels))
    plotter.set_background([BEHIND] * 3)
    actor = plotter.add_volume(
        pyvista.wrap(make_image_data(case.voxels, case.spacing)),
        cmap=ListedColormap(colours),
        opacity=255 * a,
        clim=(low, high),
        blending=BLENDING[case.renderer],
        opacity_unit_distance=unit,
        show_scalar_bar=False,
    )
    if setting == "careful" and not case.entry["labels"]:
        actor.prop.interpolation_type = "linear"
    aim_camera(plotter.camera, case)
    plotter.render_window.SetMultiSamples(0)
    return plotter
