"""The quarter model's mesh: graded hexahedra of beam and sphere, matched where they touch."""

from impactlab.reference.solid.mesh.cost import Cost as Cost
from impactlab.reference.solid.mesh.cost import estimate as estimate
from impactlab.reference.solid.mesh.cost import least_cost as least_cost
from impactlab.reference.solid.mesh.mesh import BEAM as BEAM
from impactlab.reference.solid.mesh.mesh import SPHERE as SPHERE
from impactlab.reference.solid.mesh.mesh import Mesh as Mesh
from impactlab.reference.solid.mesh.quarter import quarter_mesh as quarter_mesh
