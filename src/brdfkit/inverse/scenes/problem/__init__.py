"""Defines what `refine` minimises: the scene, its parameters, and the pictures to match."""
