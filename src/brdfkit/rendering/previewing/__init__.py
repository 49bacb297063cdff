"""Pictures without paths and without noise: `preview`."""
