"""impactlab: a sphere strikes an elastic-plastic beam.

One impact: Impact (of Sphere, Beam and Material, or paper_impact), Discretisation, simulate.
Many: simulate_many; or a Study of a Grid, Sobol, Morris, Fast, Delta, Pawn or Regression sample of
Uniform, LogUniform, Normal, TruncatedNormal, Lognormal and Triangular parameters.
Responses or a model of your own: Function. What they say: analyse, answers, plot, load_surrogate.
What is wrong with a study: StudyError.

>>> import impactlab as il
>>> run = il.simulate(il.paper_impact("5 m/s"), duration="1 ms")
"""

from typing import Any

import lazy_loader

# Names load on first use, so that the command line answers at once.
_load, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)


def __getattr__(name: str) -> Any:
    if name == "__version__":
        from importlib.metadata import version

        return version("impactlab")
    return _load(name)
