"""Spherical Gaussians: any BRDF × cosine as a few lobes per view, for lighting without noise.

`lobe_table.py` makes the table of a material's lobes by one of four methods: `gmm.py` fits a
`mixture.py` to each view, `single_lobe.py` one lobe or sharper ones in its place, and `elliptic.py`
spreads these over an ellipse. `one_view.py` holds the values that they fit, and
`von_mises_fisher.py` the formulas of a lobe.
"""

from brdfkit.lighting.spherical_gaussians.lobe_table import LobeTable, lobe_table

__all__ = ["LobeTable", "lobe_table"]
