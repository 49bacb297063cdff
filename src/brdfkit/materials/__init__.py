"""Measured BRDFs: their file formats, downloads, interpolation, audits and plots.

`measured/` holds the class `Measured`, and `goniometer/` simulates the measurement of a rough
surface.
"""
