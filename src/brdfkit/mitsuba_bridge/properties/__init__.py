"""Declares, reads and checks the parameters that a scene gives to a plugin."""
