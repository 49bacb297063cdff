import brdfkit as bk  # noqa: I001, before mitsuba: it chooses the LLVM that Mitsuba loads
import mitsuba as mi
from brdfkit.distance_fields import box, capped_cylinder, plane, sphere
from math import pi

mi.set_variant("llvm_ad_rgb")

hole = capped_cylinder((0, 0, -2), (0, 0, 2), 0.5)
field = sphere(1) & box(1.5)
field -= hole | hole.rotate(pi / 2, (1, 0, 0)) | hole.rotate(pi / 2, (0, 1, 0))
field = field.rotate(0.5).at(0, 0, 0.75).made_of("plastic") | plane()

view = mi.ScalarTransform4f().look_at([0, -5, 3], [0, 0, 0.6], [0, 0, 1])
scene = {
    "type": "scene",
    "integrator": {
        "type": "distance_field",
        "field": field.to_json(),
        "plastic": bk.load("satin_plastic").scene_dict(),
    },
    "sensor": {
        "type": "perspective",
        "fov": 36,
        "to_world": view,
        "film": {"type": "hdrfilm", "width": 480, "height": 300},
    },
    "lamp": {
        "type": "sphere",
        "center": [-3, -3, 5],
        "radius": 0.7,
        "emitter": {"type": "area", "radiance": 50.0},
    },
}
picture = mi.render(mi.load_dict(scene), spp=16)
