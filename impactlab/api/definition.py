"""A study as an object, for Python and notebooks."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from html import escape
from pathlib import Path
from typing import Any

from impactlab.api.folder import StudyFolder
from impactlab.files import replaced
from impactlab.methods.sampling import Sampling
from impactlab.model.discretisation import Discretisation
from impactlab.model.impact import Impact
from impactlab.model.quantities import Quantity
from impactlab.study.schema import readers, yaml_file
from impactlab.study.solvers.own import Function, register
from impactlab.validation.errors import Problem, StudyError
from impactlab.validation.fields import plain


class Study(StudyFolder):
    """A study of many impacts: sampled, solved, analysed, drawn and reported.

    The arguments are the keys of a study file (docs/studies.md), and are read by the same reader:
    `Study(...)`, `Study.from_yaml(...)` and the command line run the same code on the same text.
    Runs, analysis, figures and report go to `folder`, and are found there again by whoever runs the
    same study: Python or the command line. The attributes `title` and `name` keep these arguments.

    Parameters
    ----------
    title : str
        Title, one line.
    sampling : Grid, Sobol, Fast, Morris, Latin, Delta, Hsic, Pawn, RbdFast, \
        Regression, Shapley, TargetHsic or mapping
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
        Names (impactlab.analysis.ANALYSES); by default all.
    limits : mapping of str to Quantity, optional
        Limits by name of the response: `analyse` gives the probability that a run exceeds them.
    store : mapping, optional
        Stored histories and profiles, as in a file.
    analysis : mapping, optional
        Settings of the analysis, as in a file.
    measurements : sequence of str, optional
        Files that the report compares with the runs (see `compare`).
    multifidelity : mapping, optional
        Slow model: `{"high": {"nodes": 601}, "pairs": 40}` solves few runs of it beside many of the
        study's, as `multifidelity` does, and the report opens with what they tell.
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
        multifidelity: Mapping[str, Any] | None = None,
        description: str | None = None,
        function: str | Function | Callable[..., Any] | None = None,
        name: str | None = None,
        results: str | Path = "results",
    ) -> None:
        """Read the arguments as a study file is read."""
        python: dict[str, str] = {}
        if isinstance(responses, Mapping):
            for response, call in responses.items():
                if not isinstance(call, str):
                    with _problems_at(f"responses.{response}"):
                        if getattr(call, "vectorized", False):
                            raise ValueError("is vectorized, which a model alone can be")
                        python[response] = register(response, call)
            responses = list(responses)
        if function is not None and not isinstance(function, str):
            with _problems_at("function"):
                function = register(getattr(function, "__name__", "model"), function)
        sections = {
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
            "multifidelity": multifidelity,
        }
        content: dict[str, Any] = {}
        for key, section in sections.items():
            with _problems_at(key):
                content |= {} if section is None else {key: plain(section)}
        name = _name(title, name)
        super().__init__(readers.study_of_content(name, content, Path("Study")), results)

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
        study = cls.__new__(cls)
        StudyFolder.__init__(study, readers.read_study(path), results)
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


@contextmanager
def _problems_at(key: str) -> Iterator[None]:
    """Raise StudyError, naming the key, in place of a ValueError."""
    try:
        yield
    except ValueError as error:
        raise StudyError(Problem("Study", key, str(error))) from None


def _name(title: Any, name: str | None) -> str:
    """Return the name of a study. Raises StudyError where it cannot be that of a folder."""
    letters = (letter if letter.isascii() and letter.isalnum() else " " for letter in str(title))
    name = name or "_".join("".join(letters).lower().split())[:60] or "study"
    yaml_file.check_name(name, f"Study: name = {name!r}")
    return name
