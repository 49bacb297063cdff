"""Environment map by blocks: bright parts are sampled more often, by a small table of its blocks.

    {"type": "kdtree_envmap", "filename": "studio.exr", "scale": 1.0, "to_world": ...}

takes the place of Mitsuba's `envmap`: latitude over longitude, y up, with the same convention of
rows and columns and the same bilinear interpolation. The map is cut into `blocks` of nearly
constant power per angle. A sample chooses a block, and a point of it by a density that follows a
straight line along either angle, as the light falls off there; the thesis's is even.
`to_world` may turn and mirror the map, nothing else.

`criterion` says which block is cut next: `relative`, the squared error over the mean, which is what
a block adds to the variance of samples; or one of the thesis's, `sse` (the squared error),
`variance`, `range`. `distribution` says how a block is chosen: `exact`, by its share of the power,
walking down the cuts; by closed forms that need no walk and no table, `hyperbolic`, the thesis's
law of one parameter, noisier where sorted shares are not hyperbolic, and `steps`, eight ranges of
equal shares. `lookup` says how the block of a direction that a surface drew is found, for the
density: `texture`, by its number, stored for every cell between pixels; `tree`, by walking; `grid`,
by trying the blocks that a square of a coarse grid lists. `compensated`: only for integrators that
also sample surfaces [Karlík et al. 2019].

Mitsuba's samplers `stratified`, `multijitter`, `orthogonal` and `ldsampler` stratify what blocks
are drawn with, `independent` does not; `exact` keeps the strata, the closed forms lose most.

[Ergun 2015, chapter 6]. In spectral variants a colour of the map becomes a smooth spectrum under
D65 [Mallett & Yuksel 2019], linear in the colour.
"""

from brdfkit.lighting.sampling.blocks import DISTRIBUTIONS, LOOKUPS, Blocks
from brdfkit.lighting.sampling.emitter import MAP_PARAMETERS, environment_emitter, make_small_sky
from brdfkit.lighting.sampling.tree import CRITERIA
from brdfkit.mitsuba_bridge.properties.declarations import count, word

PARAMETERS = MAP_PARAMETERS | {
    "blocks": count(4096, (1, 1_000_000), "blocks that the map is cut into at most"),
    "criterion": word(CRITERIA, "which block is cut next"),
    "distribution": word(DISTRIBUTIONS, "how a block is chosen"),
    "lookup": word(LOOKUPS, "how the density at a direction is found"),
}


def define(mi):
    """The class of `mi.Emitter` for the current variant."""

    class KdtreeEnvmap(environment_emitter(mi, PARAMETERS)):
        def make_sampler(self, brightness):
            chosen = self.criterion, self.distribution, self.lookup
            return Blocks(brightness, self.blocks, *chosen)

    return KdtreeEnvmap


def example():
    """A small sky with a sun, for the checks."""
    return {"type": "kdtree_envmap", "bitmap": make_small_sky(), "blocks": 64}
