"""Computes the plots of a material's page: arrays from materials and settings, for the page."""
