"""Checks what the thesis says of its application against `brdfkit view`, by the view's messages."""

import numpy as np
from brdfkit.theses.lesar2018.renderers import RENDERERS

from brdfkit.core.jit.llvm import use_variant
from brdfkit.core.jit.threads import in_turn
from brdfkit.theses.claims import NOT_RUN, Claim, to_verdict
from brdfkit.theses.page import Section, Table
from brdfkit.theses.timing import compare_times, measure_in_turns
from brdfkit.viewing.session import Session
from brdfkit.viewing.volumes.application import VolumeApplication
from brdfkit.volumes.made import make_volume

SECONDS = 40
VOXELS, SIZE = 128, 64  # of the smoke, and pixels along an edge of its pictures
FRAME = 256  # pixels along an edge of the pictures whose time is measured
PASSES, REFERENCE = (1, 4, 16), 80
TURNS = 5  # of pictures at rest and in motion, whose times are compared
CLOSE = 0.2  # an error may be larger or smaller than σ/√n by this share
LIT = "single_scattering", "isosurface"
AVERAGED = "single_scattering"  # by the thesis
# A change of each part of a view, and the renderers that it concerns
PARTS = {
    "tone mapper": ({"tone.curve": "range", "tone.high": 0.5}, RENDERERS),
    "camera": ({"camera.azimuth": 40.0}, RENDERERS),
    "transfer function": (
        {"transfer.points": [[0.0, "#000000", 0.0], [1.0, "#40ff80", 1.0]]},
        [name for name in RENDERERS if name != "isosurface"],
    ),
    "transfer function of two dimensions": ({"transfer.mode": "bumps2d"}, ["emission_absorption"]),
    "surface's value": ({"level": 0.6}, ["isosurface"]),
    "light": ({"light.turn": 90.0}, LIT),
}
TEXT = f"""The thesis's application is a page that renders by itself, in WebGL 2. `brdfkit view` has
Python render, and its page shows the pictures. Here its messages are sent and answered without a
page: smoke of {VOXELS}³ voxels in {SIZE} × {SIZE} pixels, and in {FRAME} × {FRAME} where times are
measured, in seconds of CPU. An iteration takes one sample per pixel. Panels and gestures are tested
in a browser, by brdfkit's own tests."""


@in_turn
def check_claims(sources, report):
    """Check the claims on the application; return their section of the page."""
    use_variant()
    session = Session(VolumeApplication(make_volume("smoke", (VOXELS,) * 3)))
    session.handle({"type": "hello", "width": SIZE, "height": SIZE, "state": None})
    found = {name: try_parts(session, name) for name in RENDERERS}
    report(1, 3)
    errors = {name: measure_convergence(session, name) for name in RENDERERS}
    report(2, 3)
    ratios = {name: measure_response(session, name) for name in RENDERERS}
    claims = [
        claim_parts(found),
        claim_samples(session),
        claim_convergence(errors),
        claim_response(ratios),
        claim_page(),
    ]
    rows = [
        (
            name,
            *("yes" if found[name].get(part) else "" for part in ("renderer", *PARTS)),
            *(f"{e:.2f}" for e in errors[name]),
            f"{ratios[name].value:.1f}",
        )
        for name in RENDERERS
    ]
    heads = "", "renderer", *PARTS, *(f"error, n = {n}" for n in PASSES), "moving"
    caption = """"yes": the picture changes at once. Errors: root mean square against another run,
over σ/√n. "moving": how many times as fast an iteration is while something moves."""
    return Section("The application", TEXT, claims, [Table(heads, rows, caption)])


def show(session, changes, moving=False):
    """Change the state of a view, and return its next picture as an encoded file."""
    session.handle({"type": "set", "changes": changes, "moving": moving})
    while True:
        for message, buffers in session.work():
            if message["type"] == "picture":
                session.handle({"type": "shown", "number": message["number"]})
                return buffers[0]


def try_parts(session, renderer):
    """Return whether the picture of a renderer changes with each part that concerns it."""
    other = "isosurface" if renderer == AVERAGED else AVERAGED
    before, after = (show(session, {"renderer": name}) for name in (other, renderer))
    found = {"renderer": after != before}
    for part, (changes, concerned) in PARTS.items():
        if renderer in concerned:
            session.handle({"type": "reset"})
            before = show(session, {"renderer": renderer})
            found[part] = show(session, changes) != before
    session.handle({"type": "reset"})
    return found


def measure_convergence(session, renderer):
    """Return the root mean square error after each of `PASSES`, over σ/√n of a sample's σ."""
    app = session.application
    state = app.change(app.first_state(), {"renderer": renderer})
    passes = np.stack(
        [app.render(state, 0, (SIZE, SIZE), False, seed) for seed in range(REFERENCE)]
    ).astype(float)
    first, last = passes[: max(PASSES)], passes[max(PASSES) :]
    variance = last.var(axis=0, ddof=1).mean()
    reference = last.mean(axis=0)
    if not variance:
        return [float(np.abs(first - reference).max())] * len(PASSES)
    # The reference has an error, too
    expected = [np.sqrt(variance * (1 / n + 1 / len(last))) for n in PASSES]
    errors = [np.sqrt(np.square(first[:n].mean(axis=0) - reference).mean()) for n in PASSES]
    return [float(e / x) for e, x in zip(errors, expected, strict=True)]


def measure_response(session, renderer):
    """Return the ratio of the times of a picture at rest, and of one while the camera moves."""
    session.handle({"type": "resize", "width": FRAME, "height": FRAME})
    azimuths = iter(range(1000))
    ways = {}
    for moving in (False, True):

        def turn(moving=moving):
            show(session, {"camera.azimuth": float(next(azimuths))}, moving)

        show(session, {"renderer": renderer}, moving)
        ways[moving] = turn
    seconds = measure_in_turns(ways, TURNS)
    return compare_times(seconds[False], seconds[True])


def claim_parts(found):
    """Claim that the parts of a view are exchanged independently of each other."""
    tried = [works for parts in found.values() for works in parts.values()]
    return Claim(
        "Renderer, tone mapper, transfer function, camera and light are parts of their own, each "
        "exchanged while the program runs.",
        "ch. 6",
        "four renderers, two tone mappers",
        f"{sum(tried)} of {len(tried)} changes show in the next picture, by {len(found)} renderers",
        to_verdict(all(tried) and len(found) == len(RENDERERS)),
    )


def claim_samples(session):
    """Claim that a change begins the picture anew, and a tone mapper's does not."""
    kept, anew = [], []
    for name in RENDERERS:
        changes = [change for change, concerned in PARTS.values() if name in concerned]
        for change in changes:
            show(session, {"renderer": name})
            for _ in range(3):
                session.work()
            session.handle({"type": "shown", "number": session.number})
            before = session.passes
            show(session, change)
            if any(part.startswith("tone.") for part in change):
                kept.append(session.passes >= before > 1)
            else:
                anew.append(session.passes == 1)
            session.handle({"type": "reset"})
    return Claim(
        "Tone mappers follow the renderer in the pipeline; any other change resets it.",
        "ch. 6",
        "a diagram",
        f"samples are kept by {sum(kept)} of {len(kept)} renderers when the tone mapper changes, "
        f"and begun anew after {sum(anew)} of {len(anew)} other changes",
        to_verdict(all(kept) and all(anew)),
    )


def claim_convergence(errors):
    """Claim that pictures converge iteration by iteration, by every renderer."""
    off = {name: max(abs(e - 1) for e in found) for name, found in errors.items()}
    return Claim(
        "The picture of scattered light converges, iteration by iteration.",
        "ch. 6, 7",
        "by eye",
        f"σ/√n after {', '.join(map(str, PASSES))} iterations within "
        + ", ".join(f"{100 * share:.0f} % by {name}" for name, share in off.items()),
        to_verdict(off[AVERAGED] < CLOSE),
        f"Confirmed within {100 * CLOSE:.0f} %. The thesis averages iterations of scattering "
        "alone: its maximum intensity keeps the largest value, its isosurface the nearest depth, "
        "its emission and absorption the last picture. brdfkit averages all four.",
    )


def claim_response(ratios):
    """Claim that response is bought by less work per picture."""
    return Claim(
        "The number of iterations for each picture shown trades quality for response.",
        "ch. 7",
        "10 to 20 iterations per second and more, whose renderer is not named",
        ", ".join(f"{ratio.value:.1f} times by {name}" for name, ratio in ratios.items())
        + " as fast while the camera moves",
        NOT_RUN,
        "brdfkit trades otherwise: half the resolution, and half the steps along a ray, while "
        "something moves.",
    )


def claim_page():
    """Say that brdfkit's page does not render by itself."""
    return Claim(
        "All of it runs in a browser with WebGL 2, on a phone as well; a server that renders is "
        "left to the future.",
        "ch. 6, 8",
        "two chips, Table 7.1",
        "brdfkit has no renderer in WebGL: Python renders, and the page shows its pictures",
        NOT_RUN,
        "So a view has the numbers of scripts, and needs no graphics chip; but it needs Python. "
        "The thesis's shares of browsers with WebGL 2 are of 2017.",
    )
