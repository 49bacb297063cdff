"""Makes the plugins known to Mitsuba when it is imported."""
