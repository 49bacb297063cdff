"""Materials that are known by name: brdfkit's own, public ones, and their way here."""
