"""The functions behind the commands, as methods: steps of studies in their folders."""

from __future__ import annotations

from collections.abc import Sequence
from os import cpu_count
from pathlib import Path
from typing import TYPE_CHECKING

import xarray as xr

from impactlab.files import check_suffix, checked, opened, read_netcdf
from impactlab.model.checks import integer
from impactlab.study import REFINEMENT, RESOLUTION, steps
from impactlab.study.ownership import check_unclaimed
from impactlab.study.schema import readers
from impactlab.study.schema.declarations import AnyStudy
from impactlab.study.solvers.own import solver_name

if TYPE_CHECKING:
    from distributed import Client

    from impactlab.study.engine import Engine
    from impactlab.study.estimate import Estimate
    from impactlab.study.inventory import Status

CORES = cpu_count() or 1


class StudyFolder:
    """A study as declared, and the folder of its results, in which each step leaves its files."""

    def __init__(self, declared: AnyStudy, results: str | Path) -> None:
        """Take a study as read, and the folder of all results."""
        self.declared = declared
        self.name, self.title = declared.name, declared.title
        self.folder = steps.results_folder(self.name, Path(results))

    def design(self) -> xr.Dataset:
        """Return the coordinates of all runs.

        Returns
        -------
        xarray.Dataset
            Coordinates alone, in SI units: a dimension per parameter of a grid, ``run`` for a
            sample.

        Raises
        ------
        StudyError
            If the discretisation is still to be found.
        """
        from impactlab.study.design import design

        return design(steps.resolved(self.declared, self.folder) or self.declared)

    def estimate(self, *, workers: int = CORES) -> Estimate:
        """Return the cost of the runs, within a factor of about 3.

        Parameters
        ----------
        workers : int, optional
            Number of threads; by default that of the machine's cores.

        Returns
        -------
        Estimate
            Time, memory and disk.

        Raises
        ------
        StudyError
            If a sampled run is impossible, or pilot runs found no discretisation within the
            tolerance.
        """
        from impactlab.study.estimate import estimate

        declared = steps.resolved(self.declared, self.folder) or self.declared
        return estimate(declared, self.folder, workers)

    def status(self) -> Status | None:
        """Return the progress of the runs.

        Returns
        -------
        Status or None
            Runs solved and failed; None before the discretisation "auto" is resolved.
        """
        return steps.status(self.declared, self.folder)

    def recommend(self, *, workers: int = CORES) -> xr.Dataset:
        """Find the cheapest discretisation that meets the tolerance.

        Parameters
        ----------
        workers : int, optional
            Number of threads; by default that of the machine's cores.

        Returns
        -------
        xarray.Dataset
            Evidence from the pilot runs, as in resolution.nc.

        Raises
        ------
        StudyError
            If the study is one of a function.
        ValueError
            If another study has results of this name.
        """
        declared = readers.of_impacts(self.declared)
        check_unclaimed(declared, self.folder / "runs.nc")
        return steps.recommend(declared, self.folder / RESOLUTION, local_engine(workers))

    def run(
        self,
        *,
        workers: int = CORES,
        processes: bool = False,
        client: Client | None = None,
        force: bool = False,
        replace: bool = False,
    ) -> xr.Dataset:
        """Solve the runs that are not solved yet; return all of them, in memory.

        They are kept in `folder`: shards/ while they are solved, so that an interrupted study
        resumes where it stopped, then runs.nc.

        Parameters
        ----------
        workers : int, optional
            Number of threads or processes; by default that of the machine's cores.
        processes : bool, default False
            True for processes of this machine, which begin with the script itself: it needs
            `if __name__ == "__main__":`.
        client : distributed.Client, optional
            Dask client to use in their place; it is not closed.
        force : bool, default False
            True to run even if time or memory limits are exceeded.
        replace : bool, default False
            True to run even if another study has results of this name. A study of the same runs, or
            an earlier text of the same file, is the same study.

        Returns
        -------
        xarray.Dataset
            Responses, ``status`` and ``remarks``, in SI units, on a dimension per parameter of a
            grid, on ``run`` of a sample; with stored histories on `time`, and profiles on `x` and
            `z`.

        Raises
        ------
        StudyError
            If a limit is exceeded.
        ValueError
            If another study has results there, or the model refuses a run.
        OSError
            If a disk is full or workers fail.
        BlockingIOError
            If another process works in `folder`.
        """
        path = self.folder / "runs.nc"
        engine = local_engine(workers, processes, client)
        steps.run(self.declared, path, engine, force=force, replace=replace)
        return read_netcdf(path, "runs")

    def refine(self, *, workers: int = CORES, base_samples: int | None = None) -> xr.Dataset:
        """Solve the first runs of a Sobol sample again on finer grids.

        `report` then tells noise from numerical error.

        Parameters
        ----------
        workers : int, optional
            Number of threads; by default that of the machine's cores.
        base_samples : int, optional
            Number of base samples to solve again; by default a part of the sample.

        Returns
        -------
        xarray.Dataset
            Responses on (run, grid), as in refinement.nc.

        Raises
        ------
        ValueError
            If there are no runs of this study yet, or they are no Sobol sample of a beam model.
        """
        path = self.folder / f"{REFINEMENT}.nc"
        if self.declared.python:
            solver_name(self.declared)  # from then on its functions are known
        steps.refine(self._runs(), path, local_engine(workers), base_samples)
        return read_netcdf(path, "refinement")

    def analyse(self) -> xr.Dataset:
        """Return convergence and sensitivity as `analyse`, and keep them in `folder`.

        They include the numerical uncertainty from pilot runs of `auto`, or from `refine`.

        Returns
        -------
        xarray.Dataset
            Variables of the analyses that apply, as in analysis.nc.

        Raises
        ------
        ValueError
            If there are no runs of this study yet.
        """
        runs, path = self._runs(), self.folder / "analysis.nc"
        steps.analyse_runs(runs, path, **steps.evidence(self.declared, runs))
        return read_netcdf(path, "analysis")  # by which figures know what they were drawn from

    def figures(self) -> list[Path]:
        """Draw the figures of the report into folder/figures.

        Returns
        -------
        list of pathlib.Path
            Files of the figures.

        Raises
        ------
        ValueError
            If there are no runs of this study yet.
        """
        from impactlab.report.results import RUNS

        analysis = self.analyse()
        with checked(self._runs(), "runs", blocks=True) as solved:
            return RUNS.draw(solved, analysis, self.folder / "figures")

    def tables(self, to: str = "csv", *, responses: Sequence[str] = ()) -> list[Path]:
        """Write tables of runs, indices and answers into folder/tables.

        Parameters
        ----------
        to : str, default "csv"
            Format: "csv", "xlsx", "parquet" or "latex".
        responses : sequence of str, optional
            Names of the responses; by default all that the study asks for.

        Returns
        -------
        list of pathlib.Path
            Files of the tables.

        Raises
        ------
        ValueError
            If there are no runs of this study yet, or the format or a response is unknown.
        """
        from impactlab.report.tables import export

        analysis = self.analyse()
        with opened(self._runs(), "runs") as runs:
            return export(runs, analysis, self.folder / "tables", to, responses)

    def report(self, path: str | Path | None = None) -> Path:
        """Analyse, draw, and write the report, one file.

        Writes folder/ro-crate-metadata.json, too: content and origin of the folder.

        Parameters
        ----------
        path : str or pathlib.Path, optional
            File to write, ending in .html; by default folder/report.html.

        Returns
        -------
        pathlib.Path
            The file.

        Raises
        ------
        ValueError
            If there are no runs of this study yet, or the file's name does not end in .html.
        """
        from impactlab.report.crate import write_crate
        from impactlab.report.results import RUNS

        path = self.folder / "report.html" if path is None else Path(path)
        check_suffix("path", path, (".html",))
        analysis, figures = self.analyse(), self.folder / "figures"
        with checked(self._runs(), "runs", blocks=True) as solved:
            RUNS.draw(solved, analysis, figures)
            RUNS.write(solved, analysis, figures, path)
            write_crate(solved, self.folder, figures, path)
        return path

    def _runs(self) -> Path:
        path = self.folder / "runs.nc"
        if not path.exists():
            raise ValueError(f"{path}: there are no runs yet: call run() first")
        with opened(path, "runs") as runs:
            made_for = runs.attrs.get("study_sha256")
        if made_for != self.declared.sha256:
            raise ValueError(
                f"{path}: holds runs of another study, or of an earlier text: call run()"
            )
        return path


def local_engine(workers: int, processes: bool = False, client: Client | None = None) -> Engine:
    """Return the client's workers, or else workers of this machine."""
    from impactlab.study.engine import Engine

    workers = integer("run", "workers", workers, 1)
    return Engine("processes" if processes else "threads", workers, dask_client=client)
