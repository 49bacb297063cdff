"""Cameras, lights and convex bodies as 4 × 4 matrices and homogeneous points."""
