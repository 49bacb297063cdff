"""Solvers: how a fit finds the end of its search; each is one file, and so is `albedo_at_most.py`.

A solver is an object with one method, `minimise(objective)`. It gets an `Objective`
(`objective.py`) and returns the `End` with the least E² that it finds. Where it has an attribute
`constrained` that is True, it also keeps to the `constraints.py` of the objective. `settings.py`
knows ours by their names.

A search at random is a solver, too:

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
            return End(best, error, "as good as chance had it")
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
