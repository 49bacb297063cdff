"""Estimates the lights of photographs of a matte object from the photographs alone.

The values of a matte object have three degrees of freedom, so that lights and normals are known
from them up to a matrix A (3, 3): V = (L A⁻¹)(A B) [Hayakawa 1994]. `factors.py` finds L and B, and
`search.py` the matrix, by what is known of objects: most of the surface has the same albedo,
normals at the outline point outwards, and normals are those of a surface [Yuille & Snow 1997].
"""
