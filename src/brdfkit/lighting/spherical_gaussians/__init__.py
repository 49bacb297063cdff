"""Spherical Gaussians: any BRDF × cosine as a few lobes per view, for light without noise."""

from brdfkit.lighting.spherical_gaussians.lobe_table import LobeTable

__all__ = ["LobeTable"]
