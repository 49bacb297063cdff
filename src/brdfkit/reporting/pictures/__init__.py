"""Renders the pictures of a report, and measures their errors."""
