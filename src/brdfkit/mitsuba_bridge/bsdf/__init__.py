"""BSDF plugins of models and measurements, with lookups in tables and sampling by tables."""
