"""Measures the time of shadow rays against convex parts, height fields, and triangles by Embree."""

from brdfkit.theses.ergun2015.convex_study import (
    NO_COACD,
    PRINTED_FORM,
    can_decompose,
    make_studies,
)
from brdfkit.theses.ergun2015.moving_parts import make_plain_mesh

from brdfkit.core.jit.llvm import use_variant
from brdfkit.core.jit.threads import in_turn
from brdfkit.theses.claims import NOT_RUN, UNSTATED, Claim
from brdfkit.theses.grid import judge_over_grid
from brdfkit.theses.page import Section, Table
from brdfkit.theses.timing import compare_times, measure_in_turns, wait_for

SECONDS = 60
PIXELS, RAYS, TURNS = 96, 16, 21  # rays of each pixel to the light, and measurements
TITLE = "The time of shadow rays"
FASTER = "Rays are tested sooner against convex parts than against height fields", "Figure 9.11"
PRINTED = "markedly faster on 12 meshes, by a drawing"
EMBREE = "Rays are tested sooner against triangles, by a tree of their maker.", "Figure 9.11"
PARTS_PRINTED, FIELDS_PRINTED, PARTS, FIELDS = (
    "parts, printed",
    "fields, no clearance",
    "convex parts",
    "height fields",
)
TRIANGLES = "triangles"
TEXT = f"""CPU time in one thread of {RAYS} rays to the light from each pixel of a picture of
{PIXELS} × {PIXELS}, where it shows the mesh or the ground. All kinds take turns, {TURNS} times; in
brackets are 95 % intervals of the ratio of pairs. Parts and fields stand in the same small tree;
triangles are Mitsuba's, in Embree's. {PRINTED_FORM}"""


@in_turn
def check_claims(sources, report):
    """Check the claims on the time of shadow rays; return their section of the page."""
    use_variant()
    if not can_decompose():
        claims = [Claim(*c, PRINTED, "", NOT_RUN, NO_COACD) for c in (FASTER, EMBREE)]
        return Section(TITLE, TEXT, claims)
    found, ratios, rows = make_studies(sources), {}, []
    for name, study in found.items():
        seconds = measure_rays(study)
        pairs = (
            (FIELDS_PRINTED, PARTS_PRINTED),
            (FIELDS, PARTS),
            (PARTS_PRINTED, TRIANGLES),
            (PARTS, TRIANGLES),
        )
        ratios[name] = {pair: compare_times(*(seconds[kind] for kind in pair)) for pair in pairs}
        rows.append((name, *(str(ratio) for ratio in ratios[name].values())))
        report(len(rows), len(found))
    heads = (f"{slow} / {fast}" for slow, fast in next(iter(ratios.values())))
    claims = [
        claim_faster(
            "the thesis's form", {n: by[FIELDS_PRINTED, PARTS_PRINTED] for n, by in ratios.items()}
        ),
        claim_faster("brdfkit's form", {n: by[FIELDS, PARTS] for n, by in ratios.items()}),
        claim_triangles({n: by[PARTS, TRIANGLES] for n, by in ratios.items()}),
    ]
    return Section(TITLE, TEXT, claims, [Table(("mesh", *heads), rows, "Ratios of times.")])


def measure_rays(study):
    """Return the CPU seconds (TURNS,) of the shadow rays of a `Study`, by kind."""
    import mitsuba as mi

    rays, active = make_shadow_rays(study.scene)
    mesh = mi.load_dict({"type": "scene", "mesh": make_plain_mesh(study)}, parallel=False)
    occluders = {
        PARTS_PRINTED: study.make_printed_parts(),
        FIELDS_PRINTED: study.fields_without_clearance,
        PARTS: study.convex,
        FIELDS: study.fields,
    }
    functions = {
        kind: lambda by=by: wait_for(by.is_blocked(rays, active)[0])
        for kind, by in occluders.items()
    }
    functions[TRIANGLES] = lambda: wait_for(mesh.ray_test(rays, active))
    return measure_in_turns(functions, TURNS)


def make_shadow_rays(scene):
    """Return rays from what a camera sees to directions of the light, and where there are any."""
    import drjit as dr
    import mitsuba as mi

    sampler = mi.load_dict({"type": "independent"})
    sampler.seed(0, PIXELS * PIXELS * RAYS)
    index = dr.arange(mi.UInt32, PIXELS * PIXELS * RAYS) // RAYS
    place = mi.Point2f(index % PIXELS, index // PIXELS) + 0.5
    ray, _ = scene.sensors()[0].sample_ray(0.0, 0.5, place / PIXELS, mi.Point2f(0.5))
    si = scene.ray_intersect(ray)
    ds, _ = scene.environment().sample_direction(si, sampler.next_2d())
    rays, active = si.spawn_ray(ds.d), si.is_valid()
    dr.eval(rays, active)
    return rays, active


def claim_faster(form, ratios):
    """Claim that rays are tested sooner against parts of a `form`; `ratios` are those by mesh."""
    ours, verdict = judge_over_grid(
        ("mesh",), {(name,): ratio.low > 1 for name, ratio in ratios.items()}
    )
    values = [ratio.value for ratio in ratios.values()]
    return Claim(
        f"{FASTER[0]}: {form}.",
        FASTER[1],
        PRINTED,
        f"{ours}; {min(values):.2f} to {max(values):.2f} times as fast",
        verdict,
        "Where the whole interval is above 1. The thesis's numbers are lost.",
    )


def claim_triangles(ratios):
    """State how much sooner rays are tested against triangles than against convex parts."""
    values = [ratio.value for ratio in ratios.values()]
    return Claim(
        *EMBREE,
        "not to be compared, says the thesis",
        f"{min(values):.2f} to {max(values):.2f} times as fast as convex parts",
        UNSTATED,
        "Embree's kernels are native code; those of parts are compiled by Dr.Jit.",
    )
