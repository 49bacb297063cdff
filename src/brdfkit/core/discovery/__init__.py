"""Finds plugins, one file each, and reads the pages in their docstrings."""
