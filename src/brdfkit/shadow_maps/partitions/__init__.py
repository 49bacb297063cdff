"""One way to share a scene among several maps a file, by the file's name; found by being there.

Each has `parts(placement, project)`, the list of `Part`s of a `Placement`, first come, first
served; `project` makes the `Projection` of a placement.
"""
