"""What every other part uses and what knows no BRDF: errors, files, names, geometry, pages."""
