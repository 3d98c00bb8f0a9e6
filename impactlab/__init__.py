"""A sphere strikes an elastic-plastic beam: one impact, or studies of many.

>>> import impactlab as il
>>> run = il.simulate(il.paper_impact("5 m/s"), duration="10 ms")

One impact
    paper_impact      the source paper's sphere and beam, at a velocity
    corrected_impact  the same in the beam model that is nearest to 3-D
    Impact            any other one, of Sphere, Beam and Material
    ContactLaw, FlowLaw, register
                      a contact law of your own
    Discretisation    nodes, points and scheme in time
    simulate          solve it: an xarray.Dataset
    simulate_many     solve lists of parameters, in pairs or all combinations
    ImplausibleWarning, TooShortWarning  of values; of too short a duration

A study
    Study           sample, solve, resume, analyse and report many impacts
    Function        a response, or a model, of your own
    StudyError      all mistakes of a study, by key and value

Its sampling
    Grid                           all combinations of values
    Sobol, Fast                    shares of the variance
    Morris                         elementary effects
    Delta, Hsic, Pawn, RbdFast, Regression, Shapley, TargetHsic
                                   from given data: a Latin hypercube
    Latin                          several of these four at once
    Uniform, LogUniform, Normal, TruncatedNormal, Lognormal, Triangular
    Choice, Integers, Steps        one of several words, a whole number, a value of a series

What the runs say
    analyse         convergence and sensitivity, with verdicts
    runs_of_table   runs from a design made elsewhere, or from measurements
    answers         the same in sentences
    explain         why responses are missing or doubtful, in sentences
    table           runs or indices as a pandas DataFrame
    plot            figures: plot.run, plot.response, plot.sobol, plot.animate, ...
    load_surrogate  predictions without solving
    Multifidelity   a slow model by a fast one (FidelityEstimate, FidelityPrediction); multifidelity
    compare         measurements beside the runs, with verdicts
    compare_studies studies beside each other, on one page
    witness         one impact in 3-D finite elements beside the beam models
    calibrate       parameters and contact laws from measurements
    rare_event      probabilities of 1e-3 to 1e-7, and the likeliest way there
    size            the lightest design with a small probability

Quantities are SI numbers, strings with a unit or quantities of pint. `help(il.Study)` and so on
tell more, each with an example.
"""

from typing import Any

import lazy_loader

# Names load on first use, so that the command line answers at once. They are not in an `__all__`,
# for which help() would print all of their methods.
_load, __dir__, _ = lazy_loader.attach_stub(__name__, __file__)


def __getattr__(name: str) -> Any:
    if name == "__version__":
        from importlib.metadata import version

        return version("impactlab")
    return _load(name)
