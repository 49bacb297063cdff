"""brdfkit inside Mitsuba: adapters and tables that exist only in a variant of it."""
