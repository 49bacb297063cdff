"""Looks for bands under lights that are further away, and in the scenes of the tables."""

from dataclasses import replace
from itertools import pairwise

from brdfkit.theses.balint2019 import scenes
from brdfkit.theses.balint2019.bands import LEVEL, Light
from brdfkit.theses.balint2019.view import View

from brdfkit.theses.claims import Claim
from brdfkit.theses.grid import judge_over_grid

AWAY = 2, 4  # times as far: how far the light of section 6.3 is moved away
NEAR_RADII, NEAR_INVERSES = (0.25, 1.0, 4.0), (16, 32)  # radii of those lights, and their 1 / ε
SCENES = {
    "simple": scenes.simple,
    "complicated": scenes.complicated,
    "the Mandelbulb": scenes.fractal,
}
NEAR_LIGHT = "that of section 6.3"  # whose light is near
RADII = 0.5, 4.0  # of the lights in the scenes of the tables
PRACTICAL = 32  # the value of 1 / ε nearest to the largest one that the thesis calls useful
SHARES = 0.01, 0.02  # of the pixels that may lie on a band


def claim_near(found, size):
    """Claim that near and large lights need a smaller ε, by the share of pixels on bands.

    found : lights of section 6.3 by radius.
    """
    scene, banded = scenes.near_light(), {}
    for away in (1, *AWAY):
        place = tuple(float(away * x) for x in scene.light)
        view = View(replace(scene, light=place), size)
        for radius in NEAR_RADII:
            light = found[radius] if away == 1 else Light(view, radius, NEAR_INVERSES)
            for n in NEAR_INVERSES:
                banded[away, radius, n] = light.measure_banded_share(n, LEVEL)
    distances = (1, *AWAY)
    cells = {}
    for n in NEAR_INVERSES:
        near = [[banded[away, radius, n] for away in distances] for radius in NEAR_RADII]
        large = [[banded[away, radius, n] for radius in NEAR_RADII[::-1]] for away in distances]
        cells["nearness", f"1/{n}"], cells["size", f"1/{n}"] = map(all_fall, (near, large))
    ours, verdict = judge_over_grid(("cause", "ε"), cells)
    words = (
        f"radius {radius:g}: "
        + ", ".join(f"{100 * banded[away, radius, PRACTICAL]:.2f}" for away in distances)
        for radius in NEAR_RADII
    )
    return Claim(
        "Small values are needed because the light is near and large.",
        "6.3",
        "no figure",
        f"at 1/{PRACTICAL} {'; '.join(words)} % of the pixels on bands, for a light 1, "
        f"{' and '.join(map(str, AWAY))} times as far; {ours}",
        verdict,
        "A cause holds if the share of pixels on bands of a grey level falls with the distance of "
        "lights of every radius, or as the radius falls at every distance. The size of the light "
        "is a cause at 1/32, and not at 1/16.",
    )


def all_fall(rows):
    """Return whether the values of all rows fall from each to the next."""
    return all(b < a for row in rows for a, b in pairwise(row))


def claim_gain(found, size):
    """Claim that an error bound ε below 1/30 brings nothing that is seen."""
    lights = {(NEAR_LIGHT, radius): found[radius] for radius in RADII}
    for name, scene in SCENES.items():
        view = View(scene(), size)
        lights |= {(name, radius): Light(view, radius, (PRACTICAL,)) for radius in RADII}
    banded = {key: light.measure_banded_share(PRACTICAL, LEVEL) for key, light in lights.items()}
    cells = {
        (scene, f"{radius:g}", f"{100 * few:g} %"): banded[scene, radius] < few
        for scene, radius in banded
        for few in SHARES
    }
    ours, verdict = judge_over_grid(("scene", "radius", "bar"), cells)
    words = (
        f"{scene} {' and '.join(f'{100 * banded[scene, radius]:.1f}' for radius in RADII)} %"
        for scene in (*SCENES, NEAR_LIGHT)
    )
    return Claim(
        "Below ε = 1/30 nothing gets better to the eye.",
        "6.2, 7",
        "by eye; section 6.3 has 1/64 for a large light",
        f"pixels on bands at 1/{PRACTICAL}: {', '.join(words)}; {ours}",
        verdict,
        f"In the scenes of tables 6.1 to 6.3, and in the one of section 6.3, for which the thesis "
        f"itself asks for smaller values; radii {' and '.join(f'{r:g}' for r in RADII)}. Nothing "
        "is seen where fewer pixels than the bar lie on bands of a grey level.",
    )
