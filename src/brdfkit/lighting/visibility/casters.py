"""What casts shadows in a scene, found once: its shapes, or convex parts of its meshes."""

from brdfkit.lighting.visibility.of_scene import occluders_of


class Casters:
    """The casters of a scene, found when it is first asked for; those of one scene at a time.

    concavity, resolution : see `occluders_of`.
    convex : whether the convex parts of meshes do, not the meshes as they are.
    """

    def __init__(self, concavity, resolution, convex=True):
        self.concavity, self.resolution, self.convex = concavity, resolution, convex
        self.found = None, None, None  # the scene's key, and what casts shadows in it

    def of(self, scene):
        """(`Occluders`, a `mitsuba.Scene` of the other shapes); each may be None."""
        if self.found[0] != key(scene):
            parts = self.concavity, self.resolution
            self.set(scene, *(occluders_of(scene, *parts) if self.convex else (None, scene)))
        return self.found[1:]

    def set(self, scene, occluders, others):
        """Let `occluders` and the shapes of the scene `others` cast the shadows in a scene."""
        self.found = key(scene), occluders, others

    def visible(self, scene, ray, active):
        """Whether nothing lies between the ray's origin and its `maxt`."""
        import drjit as dr

        occluders, others = self.of(scene)
        if others is not None:
            active = dr.select(others.ray_test(ray, active), False, active)
        if occluders is not None:
            active = dr.select(occluders.blocked(ray, active)[0], False, active)
        return active


def key(scene):
    """What tells scenes apart; a scene holds its integrator, which would never free it.

    The shapes are held, so that no other scene's are taken for them: freed addresses come again.
    """
    return [(shape, shape.primitive_count()) for shape in scene.shapes()]
