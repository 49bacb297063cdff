"""Environment map by the usual samplers: to compare them with `kdtree_envmap`, and each other.

    {"type": "sampled_envmap", "filename": "studio.exr", "sampler": "alias"}

takes the place of Mitsuba's `envmap`, as `kdtree_envmap` does. `sampler` says how points of the map
are drawn: `cdf`, by cumulative sums and binary search, a row and then a cell; `mip`, by descending
mip levels, as `envmap` itself does; `alias`, by alias tables of the rows and of the cells of each
row [Vose 1991]. `compensated`: only for integrators that also sample surfaces, the density leaves
out what is below the map's mean [Karlík et al. 2019].
"""

from brdfkit.lighting.sampling.emitter import MAP, environment_emitter, small_sky
from brdfkit.lighting.sampling.map_samplers.alias import Alias
from brdfkit.lighting.sampling.map_samplers.tables import Cdf, Mip
from brdfkit.mitsuba_bridge.properties.declarations import word

SAMPLERS = {"cdf": Cdf, "mip": Mip, "alias": Alias}
PARAMETERS = MAP | {"sampler": word(SAMPLERS, "how points of the map are drawn")}


def define(mi):
    """The class of `mi.Emitter` for the current variant."""

    class SampledEnvmap(environment_emitter(mi, PARAMETERS)):
        def sampler_of(self, brightness):
            return SAMPLERS[self.sampler](brightness)

    return SampledEnvmap


def example():
    """A small sky with a sun, for the checks."""
    return {"type": "sampled_envmap", "bitmap": small_sky()}
