"""impactlab: a sphere strikes an elastic-plastic beam.

import impactlab as il; il.simulate(il.paper_impact(), duration=1e-3)
"""

import lazy_loader

# Names load on first use, so that the command line answers at once.
__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
