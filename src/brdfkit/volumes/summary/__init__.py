"""Summaries of volumes for `brdfkit info`: histograms, text and a figure."""
