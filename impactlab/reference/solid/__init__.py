"""An explicit 3-D finite-element model of the impact, independent of the beam models.

A quarter of beam and sphere in hexahedra (mesh), which answer motions with forces (elements,
material); masses move under these by central differences (stepping), and matched nodes are kept
from passing through each other (contact). Displacements and rotations may be large: strains are
rates of the current shape, stresses turn with the material (Jaumann). The contact takes matched
nodes to stay above each other, which holds while they slide by less than an element.
"""

from impactlab.reference.solid.mesh import Cost as Cost
from impactlab.reference.solid.mesh import Mesh as Mesh
from impactlab.reference.solid.mesh import estimate as estimate
from impactlab.reference.solid.mesh import least_cost as least_cost
from impactlab.reference.solid.mesh import quarter_mesh as quarter_mesh
from impactlab.reference.solid.solve import solve as solve
from impactlab.reference.solid.solve import solve_on as solve_on
from impactlab.reference.solid.stepping.march import PatchTooSmallError as PatchTooSmallError
from impactlab.reference.solid.stepping.rows import MOST_THREADS as MOST_THREADS
