"""The kinds of distance fields: solids, rods, fractals, grids, and what combines and moves them."""
