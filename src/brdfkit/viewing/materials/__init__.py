"""The application for materials: the scenes that show one, and the controls of its parameters."""
