"""Reproduces Figure 7.3, transfer functions on one scan, and measures the time to a new picture."""

from dataclasses import replace

import numpy as np
from brdfkit.theses.lesar2018.iterations import make_stage
from brdfkit.theses.lesar2018.scans import DENSE, find_scans, set_optical_depth

from brdfkit.core.colours import to_srgb
from brdfkit.core.jit.llvm import use_variant
from brdfkit.core.jit.threads import in_turn
from brdfkit.theses.claims import UNSTATED, Claim, measure_cpu_seconds
from brdfkit.theses.drawing import make_figure
from brdfkit.theses.page import Picture, Section
from brdfkit.volumes import TransferFunction

SECONDS = 12
SIZE, SPP, FEWER = 256, 96, 1
WHITE = 99.5  # the percentile of a picture's radiance that is shown white
FRAME = 512  # pixels along an edge of the picture whose time is measured
TEXT = """One scan in one light by `single_scattering`. After a change of the function the thesis
starts its picture anew. The first iteration takes one ray per pixel; the time is that of the change
as well, in seconds of CPU on the machine that made this page."""


@in_turn
def check_claims(sources, report):
    """Check the claims on the time to a new picture; return their section."""
    use_variant()
    import mitsuba as mi

    scan = find_scans(sources, FEWER)[0]
    drawn, chosen = make_figure(9, 2.6), make_functions(scan)
    for done, (axes, (name, function)) in enumerate(
        zip(drawn.subplots(1, len(chosen)), chosen.items(), strict=True)
    ):
        light = np.array(mi.render(make_scan_scene(scan, function, SIZE), spp=SPP), float)
        axes.imshow(to_srgb(light / np.percentile(light[light > 0], WHITE)))
        axes.set_title(name, size=9)
        axes.set_axis_off()
        report(done + 1, len(chosen) + 1)
    seconds = measure_first_picture(scan, list(chosen.values())[:2])
    claim = Claim(
        "After a change of the transfer function there is a picture in a fraction of a second.",
        "ch. 7, Figure 7.5",
        "by eye",
        f"{seconds:.2f} s for {FRAME} × {FRAME} pixels of {scan.name}",
        UNSTATED,
        "One iteration, with the bounds of its extinction found anew. The thesis speaks of a "
        "picture that can be recognised, which it does not measure.",
    )
    picture = Picture("transfer_functions", drawn, f"{scan.name} by four transfer functions.")
    return Section("Transfer functions", TEXT, [claim], pictures=[picture])


def make_functions(scan):
    """Return transfer functions for a scan by name."""
    low, high = scan.coloured.range
    span = high - low
    ramp = [(0, 0), (0.3, 0), (1, 0.15)]
    mapped = TransferFunction.from_colormap("viridis", (low, high), opacity=ramp, colour="albedo")
    core = TransferFunction(
        [low, low + 0.72 * span, low + 0.84 * span, high],
        [[0.9, 0.3, 0.2, 0], [0.9, 0.3, 0.2, 0.01], [0.95, 0.85, 0.4, 0.8], [1, 1, 0.9, 1]],
    )
    thin = replace(scan.function, extinction=DENSE / 20)
    return {
        "own": scan.function,
        "thin": thin,
        "colour map": set_optical_depth(mapped),
        "core": set_optical_depth(core),
    }


def make_scan_scene(scan, function, size):
    """Return the scene of a scan in scattered light, with a transfer function."""
    volume = scan.coloured.scene_dict(function)
    return make_stage({"type": "single_scattering", "extinction": volume}, size, scan.eye, scan.up)


def measure_first_picture(scan, pair):
    """Return the CPU seconds from a new transfer function to one sample of each pixel."""
    import mitsuba as mi

    loaded, other = (make_scan_scene(scan, function, FRAME) for function in pair)
    parameters, new = mi.traverse(loaded), mi.traverse(other)
    keys = [f"integrator.extinction.{name}" for name in ("table", "extinction")]

    def change(source):
        for key in keys:
            parameters[key] = type(parameters[key])(source[key])
        parameters.update()
        mi.render(loaded, spp=1).numpy()

    change(new)  # compiles the kernels, which is not timed
    return measure_cpu_seconds(change, new)
