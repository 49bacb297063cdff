"""How points of a map are drawn in proportion to its power: blocks, and the usual ways beside them.

A sampler is made of the map's `brightness` (rows, columns) of pixels (`environment_map`). It has
`sample(u, active)` → (x, y, density) of a point of the map, 0 ≤ x ≤ columns and 0 ≤ y ≤ rows - 1
with pixels at whole numbers and column 0 again behind the last; `density(x, y, active)`, relative
to an even one; and `nbytes`, the memory of its tables.
"""
