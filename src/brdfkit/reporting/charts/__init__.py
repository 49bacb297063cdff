"""Draws the charts of a report as SVG: albedos, lobes and slices of the BRDF."""
