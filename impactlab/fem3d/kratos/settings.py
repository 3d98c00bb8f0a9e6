"""What Kratos is told to do: contact by a mortar penalty, Newton's iterations, Bossak's scheme."""

from __future__ import annotations

import json
from typing import Any

from impactlab.fem3d.kratos.units import N_PER_MM3

PART, BEAM_TOP, SPHERE_BOTTOM = "Structure", "BeamTop", "SphereBottom"
"""Names of the whole model and of the two surfaces that may touch."""
BOSSAK = -0.3
"""Bossak's parameter: Kratos' own choice; it damps what a step cannot resolve."""
RESIDUAL_RATIO = 1e-5
"""Residual over that at a step's beginning, at which the step has converged."""
_CONTACT = "PenaltyContactFrictionless"
_MODULE = "KratosMultiphysics.ContactStructuralMechanicsApplication"


def settings(duration: float, time_step: float, penalty: float) -> str:
    """Project parameters in Kratos' JSON; s, s and N/m3."""
    return json.dumps(
        {
            "problem_data": {
                "problem_name": "impact",
                "parallel_type": "OpenMP",
                "start_time": 0.0,
                "end_time": duration - 0.5 * time_step,
                "echo_level": 0,
            },
            "solver_settings": _solver(time_step),
            "processes": {"contact_process_list": [_contact(penalty * N_PER_MM3)]},
        }
    )


def _solver(time_step: float) -> dict[str, Any]:
    return {
        "solver_type": "Dynamic",
        "model_part_name": PART,
        "domain_size": 3,
        "echo_level": 0,
        "time_integration_method": "implicit",
        "scheme_type": "bossak",
        "damp_factor_m": BOSSAK,
        "analysis_type": "non_linear",
        "model_import_settings": {"input_type": "use_input_model_part"},
        "time_stepping": {"time_step": time_step},
        "compute_reactions": False,
        "reform_dofs_at_each_step": True,
        "convergence_criterion": "contact_residual_criterion",
        "residual_relative_tolerance": RESIDUAL_RATIO,
        "residual_absolute_tolerance": 1e-3,
        "max_iteration": 10,
        "contact_settings": {"mortar_type": _CONTACT, "fancy_convergence_criterion": False},
        "linear_solver_settings": {
            "solver_type": "amgcl",
            "smoother_type": "ilu0",
            "krylov_type": "gmres",
            "coarsening_type": "aggregation",
            "tolerance": 1e-7,
            "max_iteration": 300,
        },
    }


def _contact(penalty: float) -> dict[str, Any]:
    """The process that looks for what touches; penalty in N/mm3."""
    return {
        "python_module": "penalty_contact_process",
        "kratos_module": _MODULE,
        "process_name": "PenaltyContactProcess",
        "Parameters": {
            "model_part_name": PART,
            "contact_model_part": {"0": [SPHERE_BOTTOM, BEAM_TOP]},
            "assume_master_slave": {"0": [SPHERE_BOTTOM]},
            "contact_type": "Frictionless",
            "advance_ALM_parameters": {"manual_ALM": True, "penalty": penalty},
        },
    }
