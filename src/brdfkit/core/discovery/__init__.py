"""Finds plugins, one file each, and reads the pages of help in their docstrings."""
