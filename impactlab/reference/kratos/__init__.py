"""The 3-D model in an engine that nobody here wrote: Kratos Multiphysics.

The mesh is that of impactlab.reference.solid; all else is Kratos': elements, plasticity, contact,
steps in time. It is no dependency: pip install 'impactlab[kratos]'.
"""

from impactlab.reference.kratos.engine import KratosMissingError as KratosMissingError
from impactlab.reference.kratos.solve import solve as solve
from impactlab.reference.kratos.solve import solve_on as solve_on
