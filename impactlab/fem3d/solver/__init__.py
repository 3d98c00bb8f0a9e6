"""An explicit 3-D finite-element model of the impact, independent of the beam models.

A quarter or a half of beam and sphere in hexahedra (mesh), which answer motions with forces
(elements, material); masses move under these by central differences (system, march), and matched
faces are kept from passing through each other (contact). Displacements and rotations may be large:
strains are rates of the current shape, stresses turn with the material (Jaumann). The contact takes
matched faces to stay above each other, which holds while they slide by less than an element.
"""

from impactlab.fem3d.solver.dataset import solve as solve
from impactlab.fem3d.solver.dataset import solve_on as solve_on
from impactlab.fem3d.solver.estimates import Cost as Cost
from impactlab.fem3d.solver.estimates import estimate as estimate
from impactlab.fem3d.solver.estimates import least_cost as least_cost
from impactlab.fem3d.solver.march import PatchTooSmallError as PatchTooSmallError
from impactlab.fem3d.solver.mesh import Mesh as Mesh
from impactlab.fem3d.solver.mesh import impact_mesh as impact_mesh
from impactlab.fem3d.solver.system import MOST_THREADS as MOST_THREADS
