"""Solvers, the algorithms that minimise the loss E of a fit, and constraints on its parameters.

A solver is an object with one method, `minimise(objective)`. The method takes an `Objective`
(`objective.py`), which computes E² at points, and returns the `End` with the least E² that it
finds. A solver with an attribute `constrained` = True also meets the constraints of the objective
(`constraints.py`, `albedo_at_most.py`). `settings.py` finds brdfkit's solvers by their names.

A random search, for example, is a solver::

    class RandomSearch:
        def minimise(self, objective):
            rng, best = np.random.default_rng(objective.seed), objective.starts[0]
            width, error = 0.1, objective.error(best)[0]
            for _ in range(300):
                near = best + width * rng.normal(size=(50, len(best)))
                near = objective.clip(near)
                errors = objective.error(near)
                if errors.min() < error:
                    best, error = near[errors.argmin()], errors.min()
                else:
                    width *= 0.9
            return End(best, error, "stopped after 300 rounds")
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
