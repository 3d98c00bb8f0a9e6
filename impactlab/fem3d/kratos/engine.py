"""Kratos Multiphysics, imported when it is needed; its units and its settings."""

from __future__ import annotations

import json
from dataclasses import dataclass
from importlib import import_module
from importlib.metadata import version
from typing import Any


class KratosMissingError(ImportError):
    """Kratos Multiphysics, or a part of it, is not installed."""


@dataclass(frozen=True)
class Engine:
    """core: the module KratosMultiphysics. analysis: its class of structural analyses."""

    core: Any
    analysis: Any
    version: str

    def variable(self, name: str) -> Any:
        """Return a variable of the core or of an application."""
        return self.core.KratosGlobals.GetVariable(name)


def engine(threads: int) -> Engine:
    """Return Kratos on `threads` threads, silent except for warnings.

    Raises KratosMissingError, which says what to install.
    """
    try:
        core = import_module("KratosMultiphysics")
        core.Logger.GetDefaultOutput().SetSeverity(core.Logger.Severity.WARNING)
        # These register elements, laws and conditions.
        for name in ("StructuralMechanics", "ConstitutiveLaws", "ContactStructuralMechanics"):
            import_module(f"KratosMultiphysics.{name}Application")
        module = "StructuralMechanicsApplication.structural_mechanics_analysis"
        analysis = import_module(f"KratosMultiphysics.{module}").StructuralMechanicsAnalysis
    except ImportError as error:
        raise KratosMissingError(
            f"Kratos Multiphysics is not complete here ({error}): pip install 'impactlab[kratos]'"
        ) from error
    core.ParallelUtilities.SetNumThreads(threads)
    return Engine(core, analysis, version("KratosMultiphysics"))


MM, MPA, TONNES_PER_MM3, N_PER_MM3 = 1e3, 1e-6, 1e-12, 1e-9
"""Kratos' units over SI: of lengths and velocities, stresses, densities, and penalties."""
PART, BEAM_TOP, SPHERE_BOTTOM = "Structure", "BeamTop", "SphereBottom"
"""Names of the whole model and of the two surfaces that may touch."""
RESIDUAL_RATIO = 1e-5
"""Residual over that at a step's beginning, at which the step has converged."""


def settings(duration: float, time_step: float, penalty: float) -> str:
    """Return project parameters in Kratos' JSON; arguments in s, s and N/m3."""
    solver = {
        "solver_type": "Dynamic",
        "model_part_name": PART,
        "domain_size": 3,
        "echo_level": 0,
        "time_integration_method": "implicit",
        "scheme_type": "bossak",
        "damp_factor_m": -0.3,  # Kratos' own choice; it damps what a step cannot resolve
        "analysis_type": "non_linear",
        "model_import_settings": {"input_type": "use_input_model_part"},
        "time_stepping": {"time_step": time_step},
        "compute_reactions": False,
        "reform_dofs_at_each_step": True,
        "convergence_criterion": "contact_residual_criterion",
        "residual_relative_tolerance": RESIDUAL_RATIO,
        "residual_absolute_tolerance": 1e-3,
        "max_iteration": 10,
        "contact_settings": {
            "mortar_type": "PenaltyContactFrictionless",
            "fancy_convergence_criterion": False,
        },
        "linear_solver_settings": {
            "solver_type": "amgcl",
            "smoother_type": "ilu0",
            "krylov_type": "gmres",
            "coarsening_type": "aggregation",
            "tolerance": 1e-7,
            "max_iteration": 300,
        },
    }
    contact = {
        "python_module": "penalty_contact_process",
        "kratos_module": "KratosMultiphysics.ContactStructuralMechanicsApplication",
        "process_name": "PenaltyContactProcess",
        "Parameters": {
            "model_part_name": PART,
            "contact_model_part": {"0": [SPHERE_BOTTOM, BEAM_TOP]},
            "assume_master_slave": {"0": [SPHERE_BOTTOM]},
            "contact_type": "Frictionless",
            "advance_ALM_parameters": {"manual_ALM": True, "penalty": penalty * N_PER_MM3},
        },
    }
    problem = {
        "problem_name": "impact",
        "parallel_type": "OpenMP",
        "start_time": 0.0,
        "end_time": duration - 0.5 * time_step,
        "echo_level": 0,
    }
    processes = {"contact_process_list": [contact]}
    return json.dumps({"problem_data": problem, "solver_settings": solver, "processes": processes})
