"""Writes HTML pages from templates; each page contains its style, scripts and pictures."""
