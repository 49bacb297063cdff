"""Measures order and bias of marching in even steps through emission and absorption, eq. 6.3."""

import numpy as np

from brdfkit.core.jit.llvm import use_variant
from brdfkit.core.jit.threads import in_turn
from brdfkit.theses.claims import Claim, to_verdict
from brdfkit.theses.page import Section, Table
from brdfkit.volumes.made import make_volume

SECONDS = 8
DEPTH, BEHIND, EXACT = 2.0, 0.7, 0.567472  # depth, radiance behind, and radiance by quadrature
# Steps: errors by an independent program, of a march and of one whose segments dim no own light
KNOWN = {
    8: (-2.6e-3, 0.103),
    32: (-1.6e-4, 0.0249),
    128: (-1.0e-5, 0.0062),
}
CLOSE = 0.05  # relative tolerance of errors that are known to two digits
SMOKE, DENSE, SIZE, SPP, PASSES = 48, 12.0, 64, 32, 6
STEPS, MANY = (4, 8, 16, 32), 512
TEXT = f"""A known volume: σ = 0.25 + 1.5 s, e = 0.3 + sin²s for s from 0 to {DEPTH:g}, {BEHIND:g}
behind it; L = {EXACT} by quadrature. `emission_absorption` takes the value at the middle of each
step, and is exact where it does not change. And smoke of {SMOKE}³ voxels before a white sky, the
march with a random place in each step: the mean of the light that comes through, over
{SIZE} × {SIZE} pixels and {SPP * PASSES} rays each."""


@in_turn
def check_claims(sources, report):
    """Check the claims on the errors of marching through a volume, and return their section."""
    use_variant()
    errors = {n: (render_march(n) - EXACT, march_without_dimming(n) - EXACT) for n in KNOWN}
    report(1, 3)
    truth, off = measure_bias(report)
    rows = [
        (f"{n}", *(f"{e:+.1e}" for e in found), *(f"{e:+.1e}" for e in KNOWN[n]))
        for n, found in errors.items()
    ]
    heads = "steps", "here", "no dimming, here", "apart", "no dimming, apart"
    caption = "Errors of the radiance of the known volume."
    smoke = [(name, f"{100 * mean:+.3f} %", f"{100 * error:.3f} %") for name, (mean, error) in
             off.items()]  # fmt: skip
    shown = f"Smoke: off from {truth:.4f}, and the standard error of that; both relative."
    tables = [Table(heads, rows, caption), Table(("", "off", "error"), smoke, shown)]
    claims = [claim_order(errors), claim_plain(errors), claim_bias(off)]
    return Section("Marching", TEXT, claims, tables)


def evaluate_emission(s):
    """Return the emission of the known volume [radiance per length]."""
    return 0.3 + np.sin(s) ** 2


def render_march(steps):
    """Render the radiance of the known volume by the plugin."""
    import mitsuba as mi

    n = 2048
    s = (np.arange(n)[::-1] + 0.5) / n * DEPTH  # reversed, as the camera looks from above
    volumes = {"extinction": 0.25 + 1.5 * s, "emission": evaluate_emission(s)}
    cube = mi.ScalarTransform4f().scale([1, 1, DEPTH])
    grids = {
        name: {
            "type": "gridvolume",
            "grid": mi.VolumeGrid(values.astype(np.float32).reshape(-1, 1, 1, 1)),
            "raw": True,
            "to_world": cube,
        }
        for name, values in volumes.items()
    }
    integrator = {"type": "emission_absorption", "steps": steps, **grids}
    camera = mi.ScalarTransform4f().look_at([0.5, 0.5, 5], [0.5, 0.5, 0], [0, 1, 0]).scale(0.4)
    return float(render_picture(integrator, camera, 2, BEHIND, 1).mean())


def march_without_dimming(steps):
    """Return the radiance of the known volume by segments that do not dim their own light."""
    ds = DEPTH / steps
    s = (np.arange(steps) + 0.5) * ds
    depth = (0.25 + 1.5 * s) * ds
    before = np.exp(-(np.cumsum(depth) - depth))
    return np.sum(before * evaluate_emission(s) * ds) + BEHIND * np.exp(-depth.sum())


def measure_bias(report):
    """Return the light through smoke, and its relative error and standard error by step count."""
    import mitsuba as mi

    smoke = {
        "type": "gridvolume",
        "grid": mi.VolumeGrid((DENSE * make_volume("smoke", (SMOKE,) * 3).values)[..., None]),
        "raw": True,
    }
    camera = mi.ScalarTransform4f().look_at([0.5, 0.5, 5], [0.5, 0.5, 0], [0, 1, 0]).scale(0.4)
    march = {"type": "emission_absorption", "extinction": smoke, "jitter": True}
    tracked = {"type": "single_scattering", "extinction": smoke, "albedo": 0.0}
    methods = {f"{n} steps": march | {"steps": n} for n in STEPS} | {"Woodcock": tracked}

    def render_mean(integrator):
        """Return the mean of all pixels and its standard error, from each pixel's spread over
        passes.
        """
        seeds = range(PASSES)
        found = np.stack(
            [render_picture(integrator, camera, SIZE, 1.0, SPP, seed) for seed in seeds]
        )
        spread = found[..., 0].var(axis=0, ddof=1).mean() / PASSES
        return found.mean(), np.sqrt(spread) / SIZE

    (truth, error), found = render_mean(march | {"steps": MANY, "jitter": False}), {}
    for done, (name, integrator) in enumerate(methods.items()):
        light, own = render_mean(integrator)
        found[name] = light / truth - 1, np.hypot(own, error) / truth
        report(1 + 2 * (done + 1) / len(methods), 3)
    return truth, found


def render_picture(integrator, camera, size, behind, spp, seed=0):
    """Render the pixels seen straight through a volume, with an even sky behind it."""
    import mitsuba as mi

    film = {"type": "hdrfilm", "width": size, "height": size, "rfilter": {"type": "box"}}
    scene = mi.load_dict(
        {
            "type": "scene",
            "integrator": integrator,
            "sensor": {"type": "orthographic", "to_world": camera, "film": film},
            "sky": {"type": "constant", "radiance": behind},
        },
        parallel=False,
    )
    return np.array(mi.render(scene, spp=spp, seed=seed), float)


def claim_order(errors):
    """Claim that the march is of second order."""
    off = max(abs(e / KNOWN[n][0] - 1) for n, (e, _) in errors.items())
    return Claim(
        "Even steps sum emission and absorption.",
        "eq. 6.3",
        "errors " + ", ".join(f"{e:.1e}" for e, _ in KNOWN.values()) + ", computed apart",
        "errors " + ", ".join(f"{e:.1e}" for e, _ in errors.values()),
        to_verdict(off < CLOSE),
        f"In {', '.join(map(str, KNOWN))} steps: of second order, four times the steps leave a "
        "sixteenth. The thesis derives its march elsewhere, and prints no number of steps.",
        arithmetic=True,
    )


def claim_plain(errors):
    """Claim that the form without an exponential within segments is of first order."""
    off = max(abs(e / KNOWN[n][1] - 1) for n, (_, e) in errors.items())
    return Claim(
        "A segment's light as e Δs, which it does not dim itself, is of first order.",
        "eq. 6.3",
        "errors " + ", ".join(f"{e:+.2g}" for _, e in KNOWN.values()) + ", computed apart",
        "errors " + ", ".join(f"{e:+.2g}" for _, e in errors.values()),
        to_verdict(off < CLOSE),
        "The common form: four times the steps leave a quarter.",
        arithmetic=True,
    )


def claim_bias(off):
    """Claim that marching is biased, and Woodcock tracking is not."""
    (coarse, error), (tracked, tracked_error) = off[f"{STEPS[0]} steps"], off["Woodcock"]
    z = tracked / tracked_error
    return Claim(
        "Even steps are biased, also with a random place; Woodcock tracking is not.",
        "ch. 5",
        "no figure",
        f"{STEPS[0]} steps: {100 * coarse:+.1f} %, {coarse / error:.0f} standard errors, "
        f"{STEPS[-1]} steps {100 * off[f'{STEPS[-1]} steps'][0]:+.3f} %; Woodcock: {z:+.1f} "
        f"standard errors of {100 * tracked_error:.2f} %",
        to_verdict(coarse > 5 * error and abs(z) < 3.5),
        "exp(-τ) of a random τ is too large in the mean: more passes at the same steps bring it no "
        f"nearer, more steps do. The truth is a march of {MANY} even steps. Woodcock's bias would "
        "not be seen below its standard error; `Woodcock tracking is unbiased` has a closed form.",
    )
