"""Textures of a flat sample from photographs of it."""
