"""What `mitsuba.traverse` does not say of the numbers of Mitsuba's own BSDFs."""

# Of a roughness; the lobe of a smaller one is a mirror to all samples
ROUGH = 0.001, 1.0
SHARE = 0.0, 1.0
BOUNDS = {
    **dict.fromkeys(("alpha", "alpha_u", "alpha_v", "roughness"), ROUGH),
    # of blendbsdf and mask
    **dict.fromkeys(("weight", "opacity"), SHARE),
    # of principled and principledthin
    **dict.fromkeys(("anisotropic", "clearcoat", "clearcoat_gloss", "flatness", "metallic"), SHARE),
    **dict.fromkeys(("sheen", "sheen_tint", "spec_tint", "spec_trans", "specular"), SHARE),
}
# What pictures have wrong derivatives by: of what roughplastic makes tables of, which have none,
# they were 0.5 to 0.7 of the right ones; of the colour beneath a smooth coat, 1.1
WRONG = {"RoughPlastic": ("alpha", "eta"), "SmoothPlastic": ("diffuse_reflectance",)}


def usual_bounds(parameters, key, otherwise):
    """The bounds (low, high) of an entry of a scene; `otherwise`, where it is no share and no
    roughness of a BSDF of Mitsuba's."""
    owner, name = _owner(parameters, key)
    return BOUNDS.get(name, otherwise) if owner else otherwise


def differentiated_wrongly(parameters, key):
    """Whether Mitsuba's derivatives of pictures by an entry of a scene are wrong."""
    owner, name = _owner(parameters, key)
    return name in WRONG.get(owner, ())


def _owner(parameters, key):
    """(class of the BSDF of Mitsuba's whose number it is, the number's name); "" for others."""
    import mitsuba as mi

    path = key.split(".")
    owner = parameters.properties[key][2]
    if path[-1] in ("value", "data"):  # of a texture
        owner, path = parameters.hierarchy.get(owner, (None, 0))[0], path[:-1]
    known = isinstance(owner, mi.BSDF) and type(owner).__module__ == "mitsuba"
    return (owner.class_name(), path[-1]) if known else ("", path[-1])
