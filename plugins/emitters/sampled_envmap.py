"""Environment map with common samplers: an environment light to compare with `kdtree_envmap`.

    {"type": "sampled_envmap", "filename": "studio.exr", "sampler": "alias"}

It takes the place of Mitsuba's `envmap`, like `kdtree_envmap`. `sampler` says how points of the map
are drawn: `cdf` finds a row and then a cell by binary search in cumulative sums; `mip` descends mip
levels, as `envmap` itself does; `alias` has alias tables of the rows and of the cells of each row
[Vose 1991]. With `compensated`, for integrators that also sample BSDFs, the density leaves out
everything below the mean of the map [Karlík et al. 2019].
"""

from typing import Any

import numpy as np

from brdfkit.core.array_types import (
    FloatArray,
    JitFloat,
    JitMask,
    JitVector,
    MitsubaModule,
    MitsubaObject,
)
from brdfkit.lighting.sampling.alias_table import AliasTable, make_alias_table
from brdfkit.lighting.sampling.emitter import (
    MAP_PARAMETERS,
    derive_environment_emitter,
    make_small_sky,
)
from brdfkit.lighting.sampling.power_map import cell_power, pixel_power
from brdfkit.mitsuba_bridge.arrays import Rows, find_cell
from brdfkit.mitsuba_bridge.properties.declarations import declare_choice

# `lighting/sampling/__init__.py` lists the methods that the three map samplers below share


class Mip:
    """Draws points of an environment map by mip levels of its power (`Hierarchical2D0`)."""

    def __init__(self, brightness: FloatArray) -> None:
        import mitsuba as mi

        power = pixel_power(brightness)
        power = np.append(power, power[:, :1], axis=1).astype(np.float32)
        self.rows, self.columns = power.shape[0] - 1, power.shape[1] - 1
        self.warp = mi.Hierarchical2D0(power)
        self.nbytes = 4 * round(power.size * 7 / 3)  # bytes of the map and of its mip levels

    def sample(self, u: JitVector, active: JitMask) -> tuple[JitFloat, JitFloat, JitFloat]:
        point, density = self.warp.sample(u, active=active)
        return point.x * self.columns, point.y * self.rows, density

    def density(self, x: JitFloat, y: JitFloat, active: JitMask) -> JitFloat:
        import mitsuba as mi

        point: JitVector = mi.Point2f(x / self.columns, y / self.rows)
        return self.warp.eval(point, active=active)


class Cdf:
    """Draws points of an environment map by search in cumulative sums of its cells' power."""

    def __init__(self, brightness: FloatArray) -> None:
        import mitsuba as mi

        power = cell_power(brightness).astype(np.float32)
        self.rows, self.columns = power.shape
        self.table = mi.DiscreteDistribution2D(power)
        self.nbytes = 4 * (
            power.size + self.rows
        )  # the cumulative sums within every row, and over all rows

    def sample(self, u: JitVector, active: JitMask) -> tuple[JitFloat, JitFloat, JitFloat]:
        import mitsuba as mi

        corner, probability, remainder = self.table.sample(u, active)
        point = mi.Point2f(corner) + remainder
        return point.x, point.y, probability * (self.rows * self.columns)

    def density(self, x: JitFloat, y: JitFloat, active: JitMask) -> JitFloat:
        import mitsuba as mi

        index = mi.Point2u(find_cell(x, self.columns), find_cell(y, self.rows))
        return self.table.pdf(index, active) * (self.rows * self.columns)


class Alias:
    """Draws points of an environment map by alias tables: of its rows, and of each row's cells.

    A single table of all cells would need random numbers with more bits than single precision has.
    """

    def __init__(self, brightness: FloatArray) -> None:
        power = cell_power(brightness)
        self.rows, self.columns = power.shape
        tables = [make_alias_table(row) for row in power]
        self.by_row = AliasTable(*make_alias_table(power.sum(axis=1)))
        self.by_cell = AliasTable(*(np.concatenate(part) for part in zip(*tables, strict=True)))
        self.densities = Rows(power.ravel() / power.mean())
        self.nbytes = 4 * power.size + self.by_row.nbytes + self.by_cell.nbytes

    def sample(self, u: JitVector, active: JitMask) -> tuple[JitFloat, JitFloat, JitFloat]:
        import mitsuba as mi

        row, y = self.by_row.draw_entry(u.y, 0, self.rows, active)
        column, x = self.by_cell.draw_entry(u.x, row * self.columns, self.columns, active)
        density = self.densities.at(row * self.columns + column, active=active)
        return mi.Float(column) + x, mi.Float(row) + y, density

    def density(self, x: JitFloat, y: JitFloat, active: JitMask) -> JitFloat:
        index = find_cell(y, self.rows) * self.columns + find_cell(x, self.columns)
        return self.densities.at(index, active=active)


SAMPLERS = {"cdf": Cdf, "mip": Mip, "alias": Alias}
PARAMETERS = MAP_PARAMETERS | {
    "sampler": declare_choice(SAMPLERS, "how points of the map are drawn")
}


def define(mi: MitsubaModule) -> type:
    """Return the plugin's class for Mitsuba's current variant: a `mi.Emitter`."""
    Base: MitsubaObject = derive_environment_emitter(mi, PARAMETERS)

    class SampledEnvmap(Base):
        def make_sampler(self, brightness: FloatArray) -> Any:
            return SAMPLERS[self.sampler](brightness)

    return SampledEnvmap


def example() -> dict[str, Any]:
    """Return an emitter with a small sky and a sun, to test the plugin."""
    return {"type": "sampled_envmap", "bitmap": make_small_sky()}
