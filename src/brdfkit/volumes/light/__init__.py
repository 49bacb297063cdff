"""Light transport in volumes: collisions along rays, media, emitters, and surfaces in a volume.

`majorants.py` bounds the extinction, `tracking.py` draws the distances at which light collides, and
`medium.py` combines both with albedo and emission. `vertex.py` has the points at which paths turn.
`emitters.py` computes the light that arrives there, `path_sampling.py` the light that is scattered
there, and `surface_light.py` the direct light on a surface that is not a shape of the scene.
"""
