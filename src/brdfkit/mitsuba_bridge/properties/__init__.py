"""Reads and checks the properties that a scene gives to a plugin."""
