"""Draws the charts of a report as SVG."""
