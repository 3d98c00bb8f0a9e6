"""Two programs, one mesh: the 3-D FE model and Kratos agree."""

from dataclasses import replace

import numpy as np
import pytest

from impactlab.fem3d import kratos
from impactlab.fem3d import solver as solid

pytestmark = pytest.mark.kratos

DURATION = 2.8e-4


@pytest.fixture(scope="module")
def theirs(mesh, impact):
    return kratos.solve_on(mesh, impact, duration=DURATION)


@pytest.fixture(scope="module")
def ours(mesh, impact):
    """With a contact of pairs of nodes: where nodes match, Kratos' dual multipliers make it one."""
    flat = replace(mesh, bulge=np.zeros_like(mesh.bulge))
    with pytest.MonkeyPatch.context() as patched:
        patched.setattr("impactlab.fem3d.solver.system.RULE", (np.eye(4), np.eye(4)))
        return solid.solve_on(flat, impact, duration=1.02 * DURATION)


def test_forces_agree(ours, theirs):
    """The rest comes from the penalty: pressure over 1e6 N/mm3 is 2 % of the indentation."""
    assert "stopped" not in theirs.attrs
    assert theirs.peak_force.item() == pytest.approx(ours.peak_force.item(), rel=0.025)
    assert theirs.contact_duration.item() == pytest.approx(ours.contact_duration.item(), rel=0.04)
    # deflections agree
    beneath = ours.midspan_deflection.interp(time=theirs.time)
    end = beneath[-1].item()
    assert abs(theirs.midspan_deflection - beneath).max().item() < 0.03 * end
    # PEEQ as far as an element as large as half the contact allows.
    deepest = ours.maximum_indentation.item()
    assert theirs.maximum_indentation.item() == pytest.approx(deepest, rel=0.04)
    left = ours.permanent_indentation.item()
    assert theirs.permanent_indentation.item() == pytest.approx(left, rel=0.1)
    strain = ours.peak_plastic_strain.item()
    assert theirs.peak_plastic_strain.item() == pytest.approx(strain, rel=0.25)


def test_the_sphere_loses_what_the_force_takes(theirs, impact):
    """Kratos' contact conditions against its velocities: N s."""
    after = theirs.sphere_displacement[-3:]
    left = (after[-1] - after[0]).item() / (after.time[-1] - after.time[0]).item()
    fallen = impact.velocity + impact.gravity * theirs.time[-2].item()
    pushed = theirs.contact_force.integrate("time").item()
    assert pushed == pytest.approx(impact.sphere.total_mass * (fallen - left), rel=0.003)


def test_a_contact_that_leaves_the_patch_is_told(impact):
    small = solid.impact_mesh(impact, element_size=0.4e-3, patch=0.8e-3, ratio=2.0, coarsest=20e-3)
    with pytest.raises(solid.PatchTooSmallError, match=r"above 0\.0008 m"):
        kratos.solve_on(small, impact, duration=8e-5)
