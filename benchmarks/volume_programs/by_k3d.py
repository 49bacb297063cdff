"""Draws the conformance set in K3D-jupyter, by `k3d.volume` and WebGL in Chromium.

K3D has no parallel rays, so the eye is very far away. It always lights a volume by its gradients.
So only opacities are compared: the difference of pictures before a white and a black background.
"""

import io
import shutil
from functools import cache

import k3d
import numpy as np
from PIL import Image
from playwright.sync_api import sync_playwright

from .case import PIXELS

NAME = "K3D"
SETTINGS = {
    "typed in": "A typed in as the opacity, all else at its defaults",
    "right unit": "opacity 1 - exp(-σ_t d), `alpha_coef` = the box's edge / d; 2048 samples",
}
FIELD_OF_VIEW = 1.0  # degrees
LOADED = 3000  # time until a page has drawn its picture [ms]
GPU = "--no-sandbox", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"
EDGE = 2  # length of the cube's edges


def find_version():
    return k3d.__version__


def draw_case(case, setting):
    """Return a picture (height, width, 4) with only the opacity; RGB is NaN."""
    if case.renderer != "emission_absorption" or "gradients" in case.transfer:
        return None  # others are lit, too, and opaque; there is no function of gradients
    plots = (make_plot(case, setting, colour) for colour in (0, 0xFFFFFF))
    black, white = (take_screenshot(plot.get_snapshot()) for plot in plots)
    found = np.full((PIXELS, PIXELS, 4), np.nan)
    found[..., 3] = 1 - (white - black).mean(axis=-1)
    return found


def make_plot(case, setting, background):
    v, rgb, sigma = case.sample_transfer(512)
    a, settings = np.interp(v, case.values, case.rgba[:, 3]), {}
    if setting != "typed in":
        unit = 1 / sigma.max()
        a = -np.expm1(-sigma * unit)
        settings = {"alpha_coef": EDGE / unit}
    if setting == "right unit":
        settings["samples"] = 2048
    low, high = case.values[[0, -1]]
    shares = (v - low) / (high - low)
    volume = k3d.volume(
        case.voxels.astype(np.float32),
        color_range=[low, high],
        color_map=np.column_stack([shares, rgb]).ravel().tolist(),
        opacity_function=np.column_stack([shares, a]).ravel().tolist(),
        interpolation=not case.entry["labels"],
        bounds=[-1, 1, -1, 1, -1, 1],
        **settings,
    )
    page = k3d.plot(
        background_color=background,
        camera_auto_fit=False,
        camera_fov=FIELD_OF_VIEW,
        grid_visible=False,
        menu_visibility=False,
        axes_helper=0,
        antialias=0,
        colorbar_object_id=0,
        height=PIXELS,
    )
    page += volume
    towards, _, up = case.view_axes
    distance = case.entry["half"] / np.tan(np.radians(FIELD_OF_VIEW / 2))
    page.camera = [*(-distance * towards), 0, 0, 0, *up]
    return page


def take_screenshot(html):
    """Return a screenshot (height, width, 3) of an HTML page."""
    page = start_browser().new_page(viewport={"width": PIXELS, "height": PIXELS})
    page.set_content(html)
    page.wait_for_timeout(LOADED)
    taken = page.screenshot()
    page.close()
    return np.array(Image.open(io.BytesIO(taken)).convert("RGB")) / 255


@cache
def start_browser():
    """Return a browser, the system's Chromium or Playwright's, open until the program ends."""
    chromium = sync_playwright().start().chromium
    return chromium.launch(executable_path=shutil.which("chromium"), args=list(GPU))
