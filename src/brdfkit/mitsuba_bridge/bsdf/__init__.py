"""BSDF plugins of models and of measurements, with lookups and sampling of tables."""
