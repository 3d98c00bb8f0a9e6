"""A study as an object: the functions behind the commands, for Python and notebooks."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from html import escape
from os import cpu_count
from pathlib import Path
from typing import TYPE_CHECKING, Any

import xarray as xr

from impactlab.analysis.analyse import analyse
from impactlab.analysis.measurements import compared
from impactlab.files import check_suffix, checked, opened, read_netcdf, replaced
from impactlab.methods.sampling import Sampling
from impactlab.model.checks import integer
from impactlab.model.discretisation import Discretisation
from impactlab.model.impact import Impact
from impactlab.model.parameters import PARAMETERS
from impactlab.model.quantities import Quantity
from impactlab.study import REFINEMENT, RESOLUTION, steps
from impactlab.study.ownership import check_unclaimed
from impactlab.study.schema import readers, yaml_file
from impactlab.study.schema.declarations import AnyStudy
from impactlab.study.schema.measurement_files import Given, read_measurements
from impactlab.study.schema.written import content_of
from impactlab.study.solvers.own import Function, register, solver_name
from impactlab.validation.errors import Problem, StudyError
from impactlab.variables import FLAGS, VARIABLES

if TYPE_CHECKING:
    from distributed import Client

    from impactlab.study.engine import Engine
    from impactlab.study.estimate import Estimate
    from impactlab.study.inventory import Status

_CORES = cpu_count() or 1


class Study:
    """A study of many impacts: sampled, solved, analysed, drawn and reported.

    The arguments are the keys of a study file (docs/studies.md), and are read by the same reader:
    `Study(...)`, `Study.from_yaml(...)` and the command line run the same code on the same text.
    Runs, analysis, figures and report go to `folder`, and are found there again by whoever runs the
    same study: Python or the command line.

    Parameters
    ----------
    title : str
        Title, one line.
    sampling : Grid, Sobol, Fast, Morris, Latin, Delta, Pawn, RbdFast, Regression or mapping
        Varied parameters and their values or distributions.
    impact : Impact or mapping, optional
        Impact that all runs start from.
    duration : Quantity, optional
        Simulated time, in s.
    discretisation : Discretisation, mapping or "auto", optional
        Nodes, points and time step; "auto" finds them by pilot runs.
    responses : sequence of str, str or mapping, optional
        Names; by default all. A mapping adds functions of the dataset of one impact (see
        `simulate`) that return a number, or a `Function` with a unit: `{"momentum": function,
        "peak_force": "peak_force"}`. Of a model `function`, the names of its results.
    analyses : sequence of str or str, optional
        Names (impactlab.analysis.catalogue.ANALYSES); by default all.
    limits : mapping of str to Quantity, optional
        Limits by name of the response: `analyse` gives the probability that a run exceeds them.
    store : mapping, optional
        Stored histories and profiles, as in a file.
    analysis : mapping, optional
        Settings of the analysis, as in a file.
    measurements : sequence of str, optional
        Files that the report compares with the runs (see `compare`).
    description : str, optional
        Text for the report.
    function : str, callable or Function, optional
        Model in place of the solver: the name of a test function, or a function that is called with
        a run's parameters by name and returns a number, or a mapping of `responses` to numbers.
    name : str, optional
        Name of the folder of results; by default the title in small letters and digits.
    results : str or pathlib.Path, default "results"
        Folder of all results, seen from the working folder.

    Attributes
    ----------
    folder : pathlib.Path
        Folder of the results: `results`/`name`.
    declared : object
        The study as read: impact, discretisation, sampling and the others in SI units.

    Raises
    ------
    StudyError
        If an argument is wrong: a ValueError with every problem by key and value.

    Examples
    --------
    >>> study = il.Study(
    ...     title="Depth", impact={"base": "paper", "velocity": "2 m/s"}, duration="1 ms",
    ...     discretisation=il.Discretisation(nodes=41), responses=["peak_force"],
    ...     sampling=il.Grid(parameters={"beam_depth": ["26 mm", "29 mm"]}))
    >>> study
    <impactlab.Study depth: 2 runs, results/depth>
    title: Depth
    impact: {base: paper, velocity: 2 m/s}
    discretisation: {nodes: 41, points: 9, rule: lobatto, scheme: leapfrog, courant: 0.9}
    duration: 1 ms
    sampling:
      method: grid
      parameters:
        beam_depth: [26 mm, 29 mm]
    responses: [peak_force]
    >>> study.estimate(workers=1).runs
    2
    >>> runs = study.run(workers=1)  # again: nothing is left to solve
    >>> runs.peak_force.dims, study.status().done
    (('beam_depth',), 2)
    >>> study.report("report.html").exists()
    True
    >>> study.to_yaml("studies/depth.yaml")
    >>> il.Study.from_yaml("studies/depth.yaml").name
    'depth'
    """

    def __init__(
        self,
        *,
        title: str,
        sampling: Sampling | Mapping[str, Any],
        impact: Impact | Mapping[str, Any] | None = None,
        duration: Quantity = None,
        discretisation: Discretisation | Mapping[str, Any] | str | None = None,
        responses: Sequence[str] | str | Mapping[str, Any] | None = None,
        analyses: Sequence[str] | str | None = None,
        limits: Mapping[str, Quantity] | None = None,
        store: Mapping[str, Any] | None = None,
        analysis: Mapping[str, Any] | None = None,
        measurements: Sequence[str] | None = None,
        description: str | None = None,
        function: str | Function | Callable[..., Any] | None = None,
        name: str | None = None,
        results: str | Path = "results",
    ) -> None:
        """Read the arguments as a study file is read."""
        python: dict[str, str] = {}
        if isinstance(responses, Mapping):
            python = {
                each: _key(f"responses.{each}", each, call)
                for each, call in responses.items()
                if not isinstance(call, str)
            }
            _check_names(python)
            responses = list(responses)
        if function is not None and not isinstance(function, str):
            function = _key("function", getattr(function, "__name__", "model"), function)
        keys = {
            "title": title,
            "description": description,
            "function": function,
            "python_responses": python or None,
            "impact": impact,
            "discretisation": discretisation,
            "duration": duration,
            "sampling": sampling,
            "responses": responses,
            "analyses": analyses,
            "limits": limits,
            "store": store,
            "analysis": analysis,
            "measurements": measurements,
        }
        self._set(
            readers.study_of_content(_name(title, name), content_of(keys), Path("Study")), results
        )

    def _set(self, declared: AnyStudy, results: str | Path) -> None:
        self.declared = declared
        """The study as read: impact, discretisation, sampling and the others in SI units."""
        self.folder = steps.results_folder(declared.name, Path(results))
        """The folder of the results."""

    @classmethod
    def from_yaml(cls, path: str | Path, *, results: str | Path = "results") -> Study:
        """Read a study file.

        Parameters
        ----------
        path : str or pathlib.Path
            Study file (docs/studies.md), whose name ends in .yaml.
        results : str or pathlib.Path, default "results"
            Folder of all results.

        Returns
        -------
        Study
            The study of the file.

        Raises
        ------
        StudyError
            If the file is wrong, with every problem: file, key, value and remedy.
        """
        return cls._of(readers.read_study(path), results)

    @classmethod
    def _of(cls, declared: AnyStudy, results: str | Path = "results") -> Study:
        study = cls.__new__(cls)
        study._set(declared, results)
        return study

    def to_yaml(self, path: str | Path) -> None:
        """Write the study file, which `from_yaml` and every command read.

        Parameters
        ----------
        path : str or pathlib.Path
            File to write, ending in .yaml; its name becomes that of the study.

        Raises
        ------
        StudyError
            If the name is not that of a study file, or the study has Python functions.
        """
        path = Path(path)
        yaml_file.check_path(path)
        if self.declared.python:
            reason = "a study of Python functions cannot be written to a file: keep its code"
            raise StudyError(Problem(str(path), "", reason))
        with replaced(path) as unfinished:
            unfinished.write_text(self.declared.text, encoding="utf-8")

    @property
    def name(self) -> str:
        """Name of the study, and of its folder.

        Returns
        -------
        str
            Letters, digits, _ and -.
        """
        return self.declared.name

    @property
    def title(self) -> str:
        """Title, which heads the report.

        Returns
        -------
        str
            One line.
        """
        return self.declared.title

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

    def estimate(self, *, workers: int = _CORES) -> Estimate:
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

    def recommend(self, *, workers: int = _CORES) -> xr.Dataset:
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
        return steps.recommend(declared, self.folder / RESOLUTION, _engine(workers))

    def run(
        self,
        *,
        workers: int = _CORES,
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
        engine = _engine(workers, processes, client)
        steps.run(self.declared, path, engine, force=force, replace=replace)
        return read_netcdf(path, "runs")

    def refine(self, *, workers: int = _CORES, base_samples: int | None = None) -> xr.Dataset:
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
        steps.refine(self._runs(), path, _engine(workers), base_samples)
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

        found = self.analyse()
        with checked(self._runs(), "runs", blocks=True) as solved:
            return RUNS.draw(solved, found, self.folder / "figures")

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
        found, figures = self.analyse(), self.folder / "figures"
        with checked(self._runs(), "runs", blocks=True) as solved:
            RUNS.draw(solved, found, figures)
            RUNS.write(solved, found, figures, path)
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

    def __repr__(self) -> str:
        """Return name, size and folder, and the text of the study file."""
        return f"<{self._head()}>\n{self.declared.text.rstrip()}"

    def _repr_html_(self) -> str:
        """Return the same for notebooks, the text folded."""
        text = f"<pre>{escape(self.declared.text)}</pre>"
        head = f"<b>{escape(self.title)}</b><br><code>{escape(self._head())}</code>"
        return f"{head}<details><summary>study file</summary>{text}</details>"

    def _head(self) -> str:
        return f"impactlab.Study {self.name}: {self.declared.size}, {self.folder}"


def compare(
    runs: xr.Dataset, measurements: Given, analysis: xr.Dataset | None = None
) -> xr.Dataset:
    """Compare the runs of a grid with measurements: values, uncertainties and verdicts.

    Parameters
    ----------
    runs : xarray.Dataset
        Runs of a grid study.
    measurements : str, pathlib.Path or mapping
        File (docs/measurements.md), or a mapping of its keys.
    analysis : xarray.Dataset, optional
        Analysis of the runs, for their numerical uncertainty; by default `analyse(runs)`.

    Returns
    -------
    xarray.Dataset
        A row per measurement and model on `comparison`, in SI units, with expanded uncertainties
        (k = 2).

    Raises
    ------
    StudyError
        If measurements are wrong.
    ValueError
        If the runs are not a study's.

    References
    ----------
    ASME V&V 20-2009; JCGM 100:2008 (both recalled, not read).

    Examples
    --------
    >>> study = il.Study(
    ...     title="Ours", impact=il.paper_impact("2 m/s"), duration="0.3 ms",
    ...     responses=["peak_force"], sampling=il.Grid(parameters={"nodes": [21, 41, 81]}))
    >>> force = {"quantity": "peak_force", "value": "24.5 kN", "standard_uncertainty": "1 kN"}
    >>> ours = {"title": "Force", "source": "an example, not measured", "measurements": [force]}
    >>> found = il.compare(study.run(workers=1), ours)
    >>> found.compared_verdict.attrs["flag_meanings"].split()[found.compared_verdict.item()]
    'compatible'
    """
    found = analyse(runs) if analysis is None else analysis
    return compared(runs, found, read_measurements(measurements, runs))


def calibrate(
    study: Study,
    measurements: Given,
    *,
    contact: Sequence[str] = (),
    model_error: float = 0.0,
    workers: int = _CORES,
) -> xr.Dataset:
    """Infer the parameters that a sample varies from measurements, and the weights of contact laws.

    The distributions of the sample are the prior; a parameter that all measurements state is not
    inferred. The dataset is kept as calibration.nc in the study's folder, with the figure
    calibration.svg.

    Parameters
    ----------
    study : Study
        Sample whose distributions are the prior.
    measurements : str, pathlib.Path or mapping
        File (docs/measurements.md), or a mapping of its keys.
    contact : sequence of str, optional
        Contact laws to weigh, under each of which the sample is solved; by default those that the
        sample draws.
    model_error : float, default 0
        Relative standard error of the model itself.
    workers : int, optional
        Number of threads; by default that of the machine's cores.

    Returns
    -------
    xarray.Dataset
        Posterior on `parameter`, weights on `model`, predictions on `measurement`, and equally
        weighted draws on `draw`, in SI units; the attribute `answer` holds the findings in
        sentences.

    Raises
    ------
    StudyError
        If study or measurements are wrong.
    ValueError
        If there is no posterior, with every reason (docs/measurements.md).

    References
    ----------
    Kennedy and O'Hagan (2001), J. R. Stat. Soc. B 63, 425 (recalled, not read), with a discrepancy
    of given size in place of a fitted one.

    Examples
    --------
    >>> study = il.Study(
    ...     title="Decay", function=lambda rate, start: start - 2 * rate, sampling=il.Pawn(
    ...         samples=128, parameters={"rate": il.Uniform(0, 1), "start": il.Uniform(5, 6)}))
    >>> value = {"quantity": "value", "value": 4.5, "standard_uncertainty": 0.1}
    >>> ours = {"title": "Value", "source": "an example, not measured", "measurements": [value]}
    >>> found = il.calibrate(study, ours, workers=1)
    >>> found.spread_ratio.round(1).values
    array([0.5, 1. ])
    """
    from impactlab.report.calibration import draw_and_tell
    from impactlab.study.calibration import calibrate as calibration

    names = study.declared, study.folder, measurements, _engine(workers), contact, model_error
    found = calibration(*names)
    return found.assign_attrs(answer="\n".join(draw_and_tell(found, study.folder)))


def _engine(workers: int, processes: bool = False, client: Client | None = None) -> Engine:
    from impactlab.study.engine import Engine

    workers = integer("run", "workers", workers, 1)
    return Engine("processes" if processes else "threads", workers, own=client)


def _key(path: str, name: str, function: Any) -> str:
    """Return the key of a Python function. Raises StudyError with the reason why there is none."""
    try:
        return register(name, function)
    except ValueError as error:
        raise StudyError(Problem("Study", path, str(error))) from None


def _check_names(python: Iterable[str]) -> None:
    taken = {*PARAMETERS, *VARIABLES, *FLAGS}
    for name in python:
        if not name.isidentifier() or name in taken:
            why = "another variable has it" if name in taken else "use letters, digits and _"
            problem = Problem("Study", f"responses.{name}", f"cannot name a response: {why}")
            raise StudyError(problem)


def _name(title: Any, name: str | None) -> str:
    """Return the name of a study. Raises StudyError where it cannot be that of a folder."""
    letters = (letter if letter.isascii() and letter.isalnum() else " " for letter in str(title))
    found = name or "_".join("".join(letters).lower().split())[:60] or "study"
    yaml_file.check_name(found, f"Study: name = {found!r}")
    return found
