"""How the density at a point of the map is found, which multiple importance sampling asks for.

A look-up is made of the `Tree` of blocks, their mean densities and their slopes (`block_slopes`),
in the order of `Tree.blocks`. It has `density(x, y, active)`, and `nbytes`, the memory of its
tables.
"""
