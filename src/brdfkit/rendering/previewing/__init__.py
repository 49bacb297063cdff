"""Renders previews: pictures of materials without noise, and without light between surfaces."""
