"""Environment map in blocks: an environment light that samples bright parts of its map more often.

    {"type": "kdtree_envmap", "filename": "studio.exr", "scale": 1.0, "to_world": ...}

It takes the place of Mitsuba's `envmap`, with smaller tables for sampling: the map has the same
layout of latitude over longitude with y up, the same convention of rows and columns, and the same
bilinear interpolation. A k-d tree cuts it into `blocks` of nearly constant power per angle. A
sample chooses a block, then a point in it, with a density that is linear along both angles, as the
light falls off there; in the thesis this density is constant. `to_world` may only rotate and mirror
the map.

`criterion` says which block is cut next. With `relative` it is the block with the largest squared
error over its mean, which is what a block adds to the variance of samples. The thesis has three
other criteria: the largest squared error (`sse`), `variance` and `range`.

`distribution` says how a sample chooses a block. `exact` walks down the tree, by the share of each
block in the power. `alias` has the same shares in an alias table, which is four to six times as
fast [Vose 1991]. Two closed forms need no walk and no table: `hyperbolic` is the thesis's law
with one parameter, and noisier where the sorted shares are not hyperbolic; `steps` has eight ranges
of equal shares.

`lookup` says how the density finds the block in a direction that a BSDF drew. `texture` stores the
number of the block for every cell between pixels, `tree` walks down the tree, and `grid` tries the
blocks that a square of a coarse grid lists. `compensated` is for integrators that also sample BSDFs
[Karlík et al. 2019].

Mitsuba's samplers `stratified`, `multijitter`, `orthogonal` and `ldsampler` stratify the numbers
that choose blocks, `independent` does not. `exact` keeps the strata; the other ways lose most.

[Ergun 2015, chapter 6]. In spectral variants a colour of the map becomes a smooth spectrum under
D65 [Mallett & Yuksel 2019], linear in the colour.
"""

from typing import Any

from brdfkit.core.array_types import FloatArray, MitsubaModule, MitsubaObject
from brdfkit.lighting.sampling.blocks import DISTRIBUTIONS, LOOKUPS, Blocks
from brdfkit.lighting.sampling.emitter import (
    MAP_PARAMETERS,
    derive_environment_emitter,
    make_small_sky,
)
from brdfkit.lighting.sampling.tree import CRITERIA
from brdfkit.mitsuba_bridge.properties.declarations import declare_choice, declare_int

PARAMETERS = MAP_PARAMETERS | {
    "blocks": declare_int(
        4096, (1, 1_000_000), "largest number of blocks that the map is cut into"
    ),
    "criterion": declare_choice(CRITERIA, "which block is cut next"),
    "distribution": declare_choice(DISTRIBUTIONS, "how a block is chosen"),
    "lookup": declare_choice(LOOKUPS, "how the density at a direction is found"),
}


def define(mi: MitsubaModule) -> type:
    """Return the plugin's class for Mitsuba's current variant: a `mi.Emitter`."""
    Base: MitsubaObject = derive_environment_emitter(mi, PARAMETERS)

    class KdtreeEnvmap(Base):
        def make_sampler(self, brightness: FloatArray) -> Blocks:
            return Blocks(brightness, self.blocks, self.criterion, self.distribution, self.lookup)

    return KdtreeEnvmap


def example() -> dict[str, Any]:
    """Return an emitter with a small sky and a sun, to test the plugin."""
    return {"type": "kdtree_envmap", "bitmap": make_small_sky(), "blocks": 64}
