"""The 3-D FE model in an independent program: Kratos Multiphysics.

The mesh is that of impactlab.fem3d; all else is Kratos': elements, plasticity, contact,
steps in time. It is no dependency: pip install 'impactlab[kratos]'.
"""

from impactlab.fem3d.kratos.engine import KratosMissingError as KratosMissingError
from impactlab.fem3d.kratos.solve import solve as solve
from impactlab.fem3d.kratos.solve import solve_on as solve_on
