"""Spherical Gaussians: a material's BRDF × cosine as a few lobes per view, to light without noise.

`lobe_table.py` fits a table of lobes to a material by one of four methods. `gmm.py` fits a mixture
of lobes (`mixture.py`) to each view. `single_lobe.py` has two methods, one lobe or sharper ones in
its place, and `elliptic.py` spreads sharper ones over an ellipse. `one_view.py` evaluates the BRDF
for a view, and `von_mises_fisher.py` has the formulas of a lobe.
"""

from brdfkit.lighting.spherical_gaussians.lobe_table import LobeTable, fit_lobe_table

__all__ = ["LobeTable", "fit_lobe_table"]
