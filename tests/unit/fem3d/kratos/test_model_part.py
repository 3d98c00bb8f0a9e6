"""Kratos gets the mesh of the 3-D FE model, and steps that do not converge are cut in half."""

from dataclasses import replace

import numpy as np
import pytest

from impactlab.fem3d import kratos
from impactlab.fem3d.kratos import Run, engine
from impactlab.fem3d.solver import impact_mesh

pytestmark = pytest.mark.kratos


@pytest.fixture(scope="module")
def ready(impact, mesh):
    return Run(engine(1), mesh, impact, duration=1e-4, time_step=8e-6, penalty=1e15)


def node_values(kratos, part, name):
    variable = kratos.variable(name)
    return np.array([node.GetSolutionStepValue(variable) for node in part.Nodes])


def test_bodies_weigh_what_they_should(ready, impact):
    """By Kratos' own mass matrices (t, of a quarter), in the direction of the impact."""
    weights = {1: 0.0, 2: 0.0}
    matrix = ready.engine.core.Matrix()
    for element in ready.part.Elements:
        element.CalculateMassMatrix(matrix, ready.part.ProcessInfo)
        weights[element.Properties.Id] += 4e3 * float(np.array(matrix)[2::3, 2::3].sum())
    assert weights[1] == pytest.approx(impact.beam.mass_per_length * impact.beam.span, rel=1e-9)
    assert weights[2] == pytest.approx(impact.sphere.total_mass, rel=1e-9)


@pytest.mark.parametrize(("name", "upwards"), [("BeamTop", 1.0), ("SphereBottom", -1.0)])
def test_faces_look_out_of_their_bodies(ready, mesh, name, upwards):
    faces = ready.part.GetSubModelPart(name).Conditions
    normals = np.array([list(face.GetGeometry().UnitNormal()) for face in faces])
    area = sum(face.GetGeometry().Area() for face in faces)
    assert (normals[:, 2] * upwards > 0.95).all()
    assert area == pytest.approx(1e6 * mesh.patch**2, rel=0.01)


def test_planes_and_supports_are_held(ready, mesh):
    for axis, nodes in (("X", mesh.symmetry_x), ("Y", mesh.symmetry_y), ("Z", mesh.support)):
        variable = ready.engine.variable(f"DISPLACEMENT_{axis}")
        fixed = [node.Id - 1 for node in ready.part.Nodes if node.IsFixed(variable)]
        assert fixed == sorted(nodes.tolist())
    # only the sphere moves and falls
    below = mesh.nodes[:, 2] < 0.0
    for name, expected in (("VELOCITY_Z", -990.0), ("VOLUME_ACCELERATION_Z", -9810.0)):
        values = node_values(ready.engine, ready.part, name)
        assert (values[below] == 0.0).all()
        assert values[mesh.pole] == expected
        assert set(values.tolist()) == {0.0, expected}


def test_kinematic_hardening_is_refused(impact, mesh):
    steel = replace(impact.beam.material, kinematic_hardening_modulus=1e9)
    hardening = replace(impact, beam=replace(impact.beam, material=steel))
    with pytest.raises(ValueError, match="kinematic_hardening_modulus = 1000000000"):
        kratos.solve_on(mesh, hardening, duration=1e-5)


def stubborn(kratos, failures):
    """Kratos whose attempts with these numbers do not converge, whatever they find."""
    attempts = iter(range(1000))

    class Stubborn(kratos.analysis):
        def SolveSolutionStep(self):  # noqa: N802
            return super().SolveSolutionStep() and next(attempts) not in failures

    return replace(kratos, analysis=Stubborn)


def history(impact, failures, duration=26e-6):
    mesh = impact_mesh(impact, element_size=2e-3, ratio=2.0, coarsest=30e-3)
    kratos = stubborn(engine(1), failures)
    run = Run(kratos, mesh, impact, duration=duration, time_step=8e-6, penalty=1e15)
    run.go(None)
    return run.history


@pytest.fixture
def _no_balance(monkeypatch):
    monkeypatch.setattr(Run, "_balanced", lambda self: False)


@pytest.mark.usefixtures("_no_balance")
def test_a_step_is_cut_in_half_and_the_others_go_on(impact):
    smooth, cut = history(impact, set()).table(), history(impact, {1}).table()
    assert (1e6 * smooth[0]).tolist() == pytest.approx([0.0, 8.0, 16.0, 24.0])
    assert (1e6 * cut[0]).tolist() == pytest.approx([0.0, 8.0, 12.0, 20.0, 28.0])
    force, sphere = 1, 2
    for row in (force, sphere):
        assert cut[row, 2] == pytest.approx(0.5 * (smooth[row, 1] + smooth[row, 2]), rel=0.1)


@pytest.mark.usefixtures("_no_balance")
def test_a_step_that_never_converges_ends_the_run_and_keeps_what_was(impact):
    short = history(impact, set(range(1, 1000)))
    assert short.stopped == "Newton's iterations did not converge after 8e-06 s"
    assert len(short.moments) == 2
