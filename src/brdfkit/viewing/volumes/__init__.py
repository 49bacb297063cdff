"""The application for volumes: its state, its scenes, its slices and its files."""
