"""Volumes: `majorants.py` bounds their extinction, `tracking.py` finds where light collides."""
