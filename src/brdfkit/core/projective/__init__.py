"""Cameras and lights as 4 × 4 matrices and homogeneous points: what shadows by projection use."""
