"""Spherical Gaussians: any BRDF × cosine as a few lobes per view, for light without noise."""

from brdfkit.lighting.spherical_gaussians.lobe_table import LobeTable
from brdfkit.lighting.spherical_gaussians.lobes_of_material import lobe_table

__all__ = ["LobeTable", "lobe_table"]
