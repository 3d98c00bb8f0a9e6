from .model.beam import Beam as Beam
from .model.discretisation import Discretisation as Discretisation
from .model.impact import Impact as Impact
from .model.material import Material as Material
from .model.paper import paper_impact as paper_impact
from .model.sphere import Sphere as Sphere
from .simulate import simulate as simulate
from .simulate import simulate_many as simulate_many
