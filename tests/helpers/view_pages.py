"""What tests of a view's page do in a browser: they drag, type and choose, and look for faults."""

import base64
import gzip
import io
from pathlib import Path

import numpy as np
from PIL import Image

AXE = Path(__file__).parents[1] / "viewing" / "axe" / "axe.min.js.gz"
FAULTS = """async () => {
    const { violations } = await axe.run(document, { resultTypes: ["violations"] });
    return violations.filter(({ impact }) => ["serious", "critical"].includes(impact)).map(
        ({ id, nodes }) => `${id}: ${nodes.map(({ html }) => html).join(" | ")}`);
}"""
# What the page says over the picture, and its statistics, at each change
SAID = """() => {
    const said = [];
    const note = () => said.push([".hint", ".samples"].map(
        (name) => document.querySelector(name).textContent));
    new MutationObserver(note).observe(document.querySelector(".hint"), { childList: true });
    return said;
}"""
THEMES = {
    "light": {"color_scheme": "light", "forced_colors": "none"},
    "dark": {"color_scheme": "dark", "forced_colors": "none"},
    "forced": {"color_scheme": "light", "forced_colors": "active"},
}


def read_axe():
    """The script of axe-core, which `FAULTS` uses."""
    return gzip.decompress(AXE.read_bytes()).decode()


def read_address(page):
    """The settings in the page's address, as JSON."""
    letters = page.url.partition("state=")[2]
    return base64.urlsafe_b64decode(letters + "=" * (-len(letters) % 4)).decode()


def pixels(page):
    """The pixels of the picture (height, width, 3)."""
    shot = page.locator("canvas").first.screenshot()
    return np.asarray(Image.open(io.BytesIO(shot)).convert("RGB"), float)


def wait_until(page, is_met, say="the page does not change"):
    """Wait until a function of no arguments returns something true, and return that."""
    for _ in range(600):  # a minute, since the machine may be busy
        if result := is_met():
            return result
        page.wait_for_timeout(100)
    raise AssertionError(say)


def wait_for_change(page, before, least=1.0):
    """Wait until the picture differs from another one by a mean of `least`."""
    pictures = []

    def differs():
        pictures.append(pixels(page))
        return np.abs(pictures[-1] - before).mean() > least

    wait_until(page, differs, "the picture does not change")
    return pictures[-1]


def drag(page, start, end, **options):
    """Drag from one place to another, in steps."""
    page.mouse.move(*start)
    page.mouse.down(**options)
    page.mouse.move(*end, steps=8)
    page.mouse.up(**options)


def number(page, name):
    """The number in a number box."""
    return float(page.get_by_role("spinbutton", name=name, exact=True).input_value())


def type_number(page, name, value):
    """Type a number into its box."""
    box = page.get_by_role("spinbutton", name=name, exact=True)
    box.fill(str(value))
    box.press("Enter")


def choose(page, label, text):
    """Choose an entry of a menu."""
    page.get_by_role("combobox", name=label, exact=True).select_option(label=text)
