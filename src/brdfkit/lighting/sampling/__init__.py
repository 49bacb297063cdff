"""Sampling of environment maps: an emitter draws directions in proportion to the map's light.

`emitter.py` is the base class of the plugins in `plugins/emitters/`. Each plugin has a *map
sampler*, made from the `brightness` (rows, columns) of a map's pixels, with

- `sample(u, active)` → (x, y, density): draws a point of the map by two uniform random numbers `u`.
  Pixels lie at whole numbers: 0 ≤ x ≤ columns, where column 0 follows the last one again, and
  0 ≤ y ≤ rows - 1. The density is relative to that of uniform points;
- `density(x, y, active)`: the density at a point;
- `nbytes`: the memory of its tables.

`blocks.py` has the default sampler: `tree.py` cuts the map into rectangular blocks,
`block_slopes.py` fits a linear density in each, `block_lookups.py` finds the block of a point,
`alias_table.py` draws blocks by a table, and `block_laws.py` by closed formulas. `power_map.py`
computes the power per angle.
"""
