"""Fits that give outliers less weight."""
