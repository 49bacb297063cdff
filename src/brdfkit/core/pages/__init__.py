"""Writes HTML pages from templates, with their style, scripts and pictures inside."""
