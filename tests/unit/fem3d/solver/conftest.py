"""A body of hexahedra in a test's hands: it moves the nodes, and gets the forces that answer."""

import numpy as np
import pytest

from impactlab.fem3d.solver.elements import FULL_MEAN, MEAN, add_forces
from impactlab.fem3d.solver.hexahedron import SCRATCH, W
from impactlab.fem3d.solver.lattice import brick
from impactlab.fem3d.solver.system import MOST_THREADS, ForceAssembly, Group
from impactlab.model.material import Material

STEEL = Material(density=7800.0, youngs_modulus=200e9, poissons_ratio=0.3, yield_stress=1e11)


class Body:
    """x: (n, 3), where the nodes are. group: the elements."""

    def __init__(self, nodes, elements, kind, steel=STEEL):
        self.x, self.elements = nodes.copy(), elements
        numbers = np.arange(len(elements))
        self.group = Group(elements, numbers, kind == "full", steel)
        self._rows = ForceAssembly([self.group], len(nodes))
        self._forces = np.zeros((self._rows.count, 3))
        self._scratch = np.zeros(SCRATCH * W)

    def move_to(self, x, dt=1.0):
        """The nodal forces (n, 3) after a straight way to x in one step."""
        group, v = self.group, (x - self.x) / dt
        self._forces[:] = 0.0
        self.x = np.ascontiguousarray(x)
        rows = self._rows.of_groups[0]
        own = (group.points == 8, group.metal, group.rate, group.nodes, rows)
        held = (group.state, group.past, group.works)
        add_forces(
            (0, MOST_THREADS),
            len(self.elements),
            *own,
            *held,
            self.x,
            v,
            dt,
            self._forces,
            self._scratch,
        )
        return self.forces()

    def forces(self):
        return np.add.reduceat(self._forces[self._rows.slots], self._rows.starts[:-1])

    def deviators(self):
        """(6, points, elements)"""
        return self.group.deviators.swapaxes(0, 1)

    def stress(self):
        """(6, points, elements): xx, yy, zz, yz, zx, xy."""
        stress = self.deviators().copy()
        mean = FULL_MEAN if self.group.points == 8 else MEAN
        stress[:3] += self.group._rows(self.group.state)[mean]
        return stress


@pytest.fixture
def make_body():
    return Body


@pytest.fixture(params=["one_point", "full"])
def kind(request):
    return request.param


@pytest.fixture
def distorted():
    """27 hexahedra with inner nodes out of place: nodes, elements, whether a node is inside."""
    line = np.linspace(0.0, 1.0, 4)
    nodes, elements = brick(line, 1.3 * line, 0.7 * line)
    inside = np.all((nodes > 1e-9) & (nodes < np.array([1.0, 1.3, 0.7]) - 1e-9), axis=1)
    shift = np.random.default_rng(1).uniform(-0.07, 0.07, nodes.shape)
    return nodes + shift * inside[:, None], elements, inside
