"""Mixture: the diffuse term of one model and the lobes of several, fitted and rendered as one.

    f = f_1 + Σ_{j>1} (f_j without its diffuse term)

The option `models` names them, as in "ggx+ggx" or "lambert+ward+cook_torrance"; wherever a model
is named, such a sum may stand. The first model gives the diffuse term. The parameters of the j-th
model are named after the model and j: ggx_2_alpha_u. Shows metals and glossy plastics, by two lobes
better than by one; measurements seldom tell three apart. [Ngan et al. 2005]; [Kurt 2007, eqs. 3.12,
3.30].
"""

from dataclasses import replace

from brdfkit.core.errors import BrdfkitError
from brdfkit.model import Model, labels, option

# Each further lobe of the same model begins narrower by this factor: equal lobes would be a saddle
# point of the fit
NARROWER = 3.0


class Mixture(Model):
    models = option("ggx+ggx", None, "the models, joined by +")

    @classmethod
    def label(cls):
        return cls.models

    @classmethod
    def parts(cls):
        """(prefix of its parameters, model, names of the weights that it brings) of every term."""
        named, parts = cls.models.split("+"), []
        if len(named) < 2:
            raise BrdfkitError(
                f"mixture: models = {cls.models} should name two or more, joined by +, as ggx+ward."
            )
        for number, label in enumerate(named, 1):
            model = labels.model(label)
            diffuse = [name for name, lobe in model().terms() if lobe.diffuse]
            brought = [n for n in model.weights() if number == 1 or n not in diffuse]
            if not brought:
                raise BrdfkitError(
                    f"{cls.models}: {label} is a diffuse term and should come first."
                )
            parts.append((f"{model.type_name()}_{number}_", model, brought))
        return parts

    @classmethod
    def made_of(cls):
        return (Mixture, *(part for _, model, _ in cls.parts() for part in model.made_of()))

    @classmethod
    def more_parameters(cls):
        parameters, seen = {}, []
        parts = cls.parts()
        for prefix, model, brought in parts:
            for name, parameter in model.parameters.items():
                if parameter.linear and name not in brought:
                    continue
                # Where a fit begins: lobes of different widths, weights that share the light
                default = parameter.default
                if parameter.width and not parameter.follows:
                    default = default * NARROWER ** (-seen.count(model) / parameter.width)
                    default = min(max(default, parameter.bounds[0]), parameter.bounds[1])
                elif parameter.linear and name != "diffuse_reflectance":
                    default = default / len(parts)
                follows = parameter.follows and prefix + parameter.follows
                own = name if name == "diffuse_reflectance" else prefix + name
                parameters[own] = replace(parameter, default=default, follows=follows)
            seen.append(model)
        return parameters

    @classmethod
    def determined(cls, samples):
        """The shape parameters of the terms that are computed from the measured directions."""
        return {
            prefix + name: value
            for prefix, model, _ in cls.parts()
            for name, value in model.determined(samples).items()
        }

    def lobes(self):
        lobes = []
        for prefix, model, brought in self.parts():
            shapes = {n: getattr(self, prefix + n) for n in model.shapes(anisotropic=True)}
            terms = model.bind(shapes).terms()
            lobes += [lobe for name, lobe in terms if name in brought]
        return tuple(lobes)
