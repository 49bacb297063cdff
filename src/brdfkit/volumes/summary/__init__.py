"""Summaries of volumes for `brdfkit info`: their properties, likely defects, and histograms."""
