"""Kratos Multiphysics, imported when it is needed."""

from __future__ import annotations

from dataclasses import dataclass
from importlib import import_module
from importlib.metadata import version
from typing import Any

APPLICATIONS = ("StructuralMechanics", "ConstitutiveLaws", "ContactStructuralMechanics")
"""Parts of Kratos that register elements, laws and conditions when they are imported."""
_ANALYSIS = "KratosMultiphysics.StructuralMechanicsApplication.structural_mechanics_analysis"


class KratosMissingError(ImportError):
    """Kratos Multiphysics, or a part of it, is not installed."""


@dataclass(frozen=True)
class Engine:
    """core: the module KratosMultiphysics. analysis: its class of structural analyses."""

    core: Any
    analysis: Any
    version: str

    def variable(self, name: str) -> Any:
        """A variable of the core or of an application."""
        return self.core.KratosGlobals.GetVariable(name)


def engine(threads: int) -> Engine:
    """Kratos on `threads` threads, silent but for warnings.

    Raises KratosMissingError, which says what to install.
    """
    try:
        core = import_module("KratosMultiphysics")
        core.Logger.GetDefaultOutput().SetSeverity(core.Logger.Severity.WARNING)
        for name in APPLICATIONS:
            import_module(f"KratosMultiphysics.{name}Application")
        analysis = import_module(_ANALYSIS).StructuralMechanicsAnalysis
    except ImportError as error:
        raise KratosMissingError(
            f"Kratos Multiphysics is not complete here ({error}): pip install 'impactlab[kratos]'"
        ) from error
    core.ParallelUtilities.SetNumThreads(threads)
    return Engine(core, analysis, version("KratosMultiphysics"))
