"""Multiple importance sampling: directions from the BRDF and from a light, combined by densities.

Kurt 2007, eqs. 4.16 to 4.19 in Veach's form. The printed form, with a further factor 1/(n_f + n_g),
halves the light of one sample each; so would a density that is not that of the samples.
"""

import numpy as np
import pytest
from batches import mean_and_error, render_batches
from small_files import adaptive, rgl_file

import brdfkit as bk

# A right renderer is further off once in 7,000 tests, for some 100 tests
SIGMA = 3.8 + 0.5
COUNTS = {"BSDF": (1, 0), "emitter": (0, 1), "both": (1, 1)}
UNEVEN = {"3 to 1": (3, 1), "1 to 3": (1, 3)}


def radiance(mi, bsdf, counts, spp=2**13):
    """Mean radiance (RGB) of a patch under a lamp at its mirror direction, and its error."""
    integrator = {"type": "direct", "bsdf_samples": counts[0], "emitter_samples": counts[1]}
    lamp = mi.ScalarTransform4f().look_at([-2, 0.3, 2], [0, 0, 0], [0, 0, 1])
    scene = mi.load_dict(
        {
            "type": "scene",
            "integrator": integrator,
            "floor": {"type": "rectangle", "bsdf": bsdf},
            "lamp": {
                "type": "rectangle",
                "to_world": lamp @ mi.ScalarTransform4f().scale(0.8),
                "emitter": {"type": "area", "radiance": 1.0},
            },
            "sensor": {
                "type": "radiancemeter",
                "origin": [2, 0, 2],
                "direction": [-1, 0, -1],
                "film": {"type": "hdrfilm", "width": 1, "height": 1, "rfilter": {"type": "box"}},
            },
        }
    )
    return mean_and_error(render_batches(scene, batches=16, samples=spp // 16), ddof=1)


MATERIALS = bk.models() | {
    "dusty_gold": lambda: bk.load("dusty_gold"),
    "dusty_gold in RGL's file": lambda: adaptive(rgl_file(bk.load("dusty_gold"))),
}


@pytest.mark.parametrize("name", MATERIALS)
def test_the_light_is_the_same_by_any_samples(name, llvm_variant):
    bsdf = MATERIALS[name]().scene_dict()
    counts = COUNTS | UNEVEN if name in ("ward", "dusty_gold") else COUNTS
    found = {label: radiance(llvm_variant, bsdf, n) for label, n in counts.items()}
    light, error = found["both"]
    assert (light > 0.01).all()
    for label, (other, other_error) in found.items():
        apart = np.abs(other - light) / np.hypot(error, other_error)
        assert (apart < SIGMA).all(), (label, other, light, apart)
