"""Defines the claims of Table 1 on six projections of shadow maps, by their scores.

`table` maps a scene to an array of scores: rows are projections, columns those of the table.
"""

from itertools import combinations

import numpy as np
from brdfkit.theses.ergun2008.printed import read_printed_table
from brdfkit.theses.ergun2008.simple_perspective import NEAR
from brdfkit.theses.ergun2008.views import PROJECTIONS

from brdfkit.theses.claims import UNSTATED, Claim, to_verdict

PARTED = 1.0  # dB: projections whose scores are closer count as equal
PSM = (
    "Of the author's PSM the thesis says only that its light's view may be opened to the whole "
    "cube, symmetric about its middle; ours is fitted on each side, and begins where something is "
    "seen."
)


def read_printed_rows():
    return np.array(list(read_printed_table("table_1").values()))


def rank_projections(column, sign):
    """Return the projections, the best first; `sign` is 1 where more is better, else -1."""
    return [list(PROJECTIONS)[i] for i in np.argsort(-sign * column, kind="stable")]


def shorten_name(name):
    words = PROJECTIONS[name]
    return words.partition("(")[2].rstrip(")") or words


def join_names(names):
    return " > ".join(map(shorten_name, names))


def claim_order(says, where, table, column, sign):
    """Claim that the order of projections is the printed one, and count the pairs in that order."""
    expected = rank_projections(read_printed_rows()[:, column], sign)
    ours = {scene: rank_projections(values[:, column], sign) for scene, values in table.items()}
    pairs = [
        f"{sum(o.index(a) < o.index(b) for a, b in combinations(expected, 2))} of 15"
        for o in ours.values()
    ]
    words = (
        f"{scene}: {join_names(order)} ({same} pairs as printed)"
        for (scene, order), same in zip(ours.items(), pairs, strict=True)
    )
    return Claim(
        says,
        where,
        join_names(expected),
        "; ".join(words),
        to_verdict(all(order == expected for order in ours.values())),
        "The printed order is that of one scene, which is not described.",
    )


def list_scenes_where(table, holds):
    """Return the scenes in which a condition holds, as text, and whether it holds in all."""
    scenes = [scene for scene, values in table.items() if holds(values)]
    return f"in {len(scenes)} of {len(table)} scenes" + (
        f": {', '.join(scenes)}" if 0 < len(scenes) < len(table) else ""
    ), len(scenes) == len(table)


def claim_best(says, table, column, sign, name):
    index = list(PROJECTIONS).index(name)
    ours, all_of_them = list_scenes_where(
        table, lambda values: np.argmax(sign * values[:, column]) == index
    )
    return Claim(
        says,
        "Table 1",
        f"{read_printed_table('table_1')[name][column]:g}",
        ours,
        to_verdict(all_of_them),
        "The scenes differ by how much of the picture is the plane: by design the best map is of "
        "that alone.",
    )


def claim_worst(says, table, column, sign, why):
    index = list(PROJECTIONS).index("perspective")
    ours, all_of_them = list_scenes_where(
        table, lambda values: np.argmin(sign * values[:, column]) == index
    )
    printed_figure = f"{read_printed_table('table_1')['perspective'][column]:g}"
    return Claim(says, "Table 1", printed_figure, ours, to_verdict(all_of_them), why)


def claim_focus(table):
    ours, all_of_them = list_scenes_where(table, lambda values: values[1, 0] < values[0, 0])
    return Claim(
        "Focusing makes better use of the map than the uniform projection.",
        "2.2.2.1",
        "the statement; but Table 1 has 0.2650 and 0.2302",
        ours,
        to_verdict(all_of_them),
        "A map of less, of which the same is seen, is used more. The printed table says the "
        "opposite of its section.",
    )


def claim_even(table):
    spread = [np.ptp(values[[0, 1, 3], 2]) for values in table.values()]
    return Claim(
        "Uniform, focused and LiSPSM hardly differ by aliasing.",
        "Table 1, 5",
        "30.50 to 30.56 dB",
        ", ".join(f"{scene} {s:.1f} dB apart" for scene, s in zip(table, spread, strict=True)),
        to_verdict(max(spread) < PARTED),
        "The printed mean of LiSPSM is lifted by one cell, 51.03 dB; without V4 it is 26.85 dB. "
        "What is seen of a deep scene is a small part of a uniform map.",
    )


def claim_relative(table):
    ours, all_of_them = list_scenes_where(table, lambda values: np.argmin(values[:, 3]) == 2)
    return Claim(
        "PSM's aliasing changes least from light to light, though it is the worst.",
        "Table 1",
        "2.03 dB, others 4.36 to 6.76",
        ours,
        to_verdict(all_of_them),
    )


def claim_steadier(table):
    ours, all_of_them = list_scenes_where(table, lambda values: values[3, 3] < values[0, 3])
    return Claim(
        "LiSPSM's aliasing changes less from light to light than the uniform one's.",
        "5",
        "5.81 and 6.70 dB",
        ours,
        to_verdict(all_of_them),
        "A reason of the thesis to recommend it.",
    )


def claim_simple(table, found):
    means = {scene: cells[..., -1, :].mean(axis=(0, 1)) for scene, cells in found.items()}
    worst = [
        scene
        for scene, (unused, dB) in means.items()
        if unused > table[scene][:, 0].max() and dB < table[scene][:, 2].min()
    ]
    ours = ", ".join(f"{scene} {q:.3f}, {dB:.1f} dB" for scene, (q, dB) in means.items())
    return Claim(
        "PSM in the simple way: its light's view opened to the whole cube, evenly about its axis.",
        "2.2.2.2",
        "which way its figures are of is not told",
        f"{ours}; worst by both scores in {', '.join(worst) or 'no scene'}",
        UNSTATED,
        f"With the camera's near plane at {NEAR:g} of the nearest distance. So the printed rank "
        "may be that of the fitting and the near plane, not of the idea.",
    )


def average_lights(cells, score):
    """Return a score (view, projection), averaged over the lights."""
    return cells[..., score].mean(axis=1)


def claim_lamp(found):
    """Claim that maps are used better with the light at the eye, view V4, than in view V1.

    The plane-optimal projection POSM is left out, as in the thesis.
    """
    five = [i for i, name in enumerate(PROJECTIONS) if name != "plane_optimal"]
    held = {
        scene: int((average_lights(q, 0)[3] < average_lights(q, 0)[0])[five].sum())
        for scene, q in found.items()
    }
    return Claim(
        "The miner's lamp, V4, uses maps better than V1, of all projections but POSM.",
        "4.2.2",
        "5 of 5",
        ", ".join(f"{scene} {n} of 5" for scene, n in held.items()),
        to_verdict(all(n == 5 for n in held.values())),
        "Where the map holds the whole scene, the view decides little.",
    )


def claim_dueling(found):
    """Claim that view V3 uses maps less than V2, which looks into the light."""
    held = {
        scene: int((average_lights(q, 0)[2] > average_lights(q, 0)[1])[: len(PROJECTIONS)].sum())
        for scene, q in found.items()
    }
    return Claim(
        "V3, which is called intermediate, uses maps less than V2, the worst case by name.",
        "4.2.2",
        "6 of 6 projections",
        ", ".join(f"{scene} {n} of 6" for scene, n in held.items()),
        to_verdict(all(n == 6 for n in held.values())),
    )
