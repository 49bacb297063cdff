"""How the density at a point of the map is found, which multiple importance sampling asks for.

A look-up is made of the `Tree` of blocks and their densities, in the order of `Tree.blocks`, and
has `density(x, y, active)`, and `nbytes`, the memory of its tables.
"""
