"""The quarter model's mesh: graded hexahedra of beam and sphere, matched where they touch."""

from impactlab.fem3d.solver.mesh.estimates import Cost as Cost
from impactlab.fem3d.solver.mesh.estimates import estimate as estimate
from impactlab.fem3d.solver.mesh.estimates import least_cost as least_cost
from impactlab.fem3d.solver.mesh.mesh import BEAM as BEAM
from impactlab.fem3d.solver.mesh.mesh import SPHERE as SPHERE
from impactlab.fem3d.solver.mesh.mesh import Mesh as Mesh
from impactlab.fem3d.solver.mesh.quarter import quarter_mesh as quarter_mesh
