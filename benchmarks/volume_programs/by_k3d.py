"""K3D-jupyter: `k3d.volume`, drawn by WebGL in Chromium.

It has no parallel rays: the eye is very far away. It lights every volume by its gradients, without
a switch for that: pictures are compared by their opacity, by what a white background adds to a
black one.
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
LOADED = 3000  # ms, until a page has drawn
GPU = "--no-sandbox", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"
EDGE = 2  # of the cube


def version():
    return k3d.__version__


def picture(case, setting):
    """The opacity alone (height, width, 4)."""
    if case.renderer != "emission_absorption" or "gradients" in case.transfer:
        return None  # others are lit, too, and opaque; there is no function of gradients
    black, white = (shown(plot(case, setting, colour)) for colour in (0, 0xFFFFFF))
    found = np.full((PIXELS, PIXELS, 4), np.nan)
    found[..., 3] = 1 - (white - black).mean(axis=-1)
    return found


def plot(case, setting, background):
    v, rgb, sigma = case.sampled(512)
    a, settings = np.interp(v, case.values, case.rgba[:, 3]), {}
    if setting == "right unit":
        unit = 1 / sigma.max()
        a = -np.expm1(-sigma * unit)
        settings = {"alpha_coef": EDGE / unit, "samples": 2048}
    low, high = case.values[[0, -1]]
    shares = (v - low) / (high - low)
    volume = k3d.volume(
        case.voxels.astype(np.float32),
        color_range=[low, high],
        color_map=np.column_stack([shares, rgb]).ravel().tolist(),
        opacity_function=np.column_stack([shares, a]).ravel().tolist(),
        interpolation=not case.told["labels"],
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
    towards, _, up = case.eye
    distance = case.told["half"] / np.tan(np.radians(FIELD_OF_VIEW / 2))
    page.camera = [*(-distance * towards), 0, 0, 0, *up]
    return page.get_snapshot()


def shown(html):
    """The picture (height, width, 3) of a page."""
    page = browser().new_page(viewport={"width": PIXELS, "height": PIXELS})
    page.set_content(html)
    page.wait_for_timeout(LOADED)
    taken = page.screenshot()
    page.close()
    return np.array(Image.open(io.BytesIO(taken)).convert("RGB")) / 255


@cache
def browser():
    """The system's Chromium, or else Playwright's, until the program ends."""
    chromium = sync_playwright().start().chromium
    return chromium.launch(executable_path=shutil.which("chromium"), args=list(GPU))
