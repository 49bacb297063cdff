"""Finds plugins, one file each, and reads what their pages say."""
