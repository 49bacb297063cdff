"""What the plugins that emit light stand on; nothing here knows Mitsuba."""
