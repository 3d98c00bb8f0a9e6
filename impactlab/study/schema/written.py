"""Sections of a study as Python objects, and the text of the study file that they stand for.

They hold what a study file holds, and nothing is checked before the whole study is: the reader of
files judges both.
"""

from __future__ import annotations

import io
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, fields
from typing import Any, ClassVar

import numpy as np
from ruamel.yaml import YAML

from impactlab.model.discretisation import Discretisation
from impactlab.model.impact import Impact, paper_impact
from impactlab.model.parameters import PARAMETERS, flatten
from impactlab.model.quantities import Quantity, as_text
from impactlab.study.errors import Problem, StudyError

Values = Mapping[str, Any]


class _Section:
    _key: ClassVar[str]

    def written(self) -> dict[str, Any]:
        """Return the section as a study file has it; what is None is left out.

        Returns
        -------
        dict
            Keys and values of the section.
        """
        snake = re.sub(r"(?<=[a-z])(?=[A-Z])", "_", type(self).__name__).lower()
        entries = {field.name: getattr(self, field.name) for field in fields(self)}  # type: ignore[arg-type]
        last = {key: entries.pop(key) for key in ("parameters",) if key in entries}
        entries = {self._key: snake} | entries | last
        return {key: plain(value) for key, value in entries.items() if value is not None}


class _Distribution(_Section):
    _key = "distribution"


@dataclass(frozen=True)
class Uniform(_Distribution):
    """Equal probability from `low` to `high`.

    Parameters
    ----------
    low, high : Quantity
        Ends of the range, in the parameter's unit.

    Examples
    --------
    >>> il.Uniform("26 mm", "29 mm")
    Uniform(low='26 mm', high='29 mm')
    """

    low: Quantity
    high: Quantity


@dataclass(frozen=True)
class LogUniform(_Distribution):
    """Equal probability of the logarithm, from `low` to `high`.

    Parameters
    ----------
    low, high : Quantity
        Ends of the range, above zero, in the parameter's unit.

    Examples
    --------
    >>> speed = il.LogUniform("0.1 m/s", "10 m/s")
    """

    low: Quantity
    high: Quantity


@dataclass(frozen=True)
class Normal(_Distribution):
    """A normal distribution; for bounded parameters `TruncatedNormal` is safer.

    Parameters
    ----------
    mean : Quantity
        Mean, in the parameter's unit.
    standard_deviation : Quantity
        Standard deviation, in the parameter's unit.

    Examples
    --------
    >>> stress = il.Normal("345 MPa", "20 MPa")
    """

    mean: Quantity
    standard_deviation: Quantity


@dataclass(frozen=True)
class TruncatedNormal(_Distribution):
    """A normal distribution that is cut at `low` and `high`.

    Parameters
    ----------
    mean : Quantity
        Mean before the cut, in the parameter's unit.
    standard_deviation : Quantity
        Standard deviation before the cut, in the parameter's unit.
    low, high : Quantity
        Ends of the range, in the parameter's unit.

    Examples
    --------
    >>> stress = il.TruncatedNormal("345 MPa", "25 MPa", low="270 MPa", high="420 MPa")
    """

    mean: Quantity
    standard_deviation: Quantity
    low: Quantity
    high: Quantity


@dataclass(frozen=True)
class Lognormal(_Distribution):
    """A normal distribution of the logarithm.

    Parameters
    ----------
    median : Quantity
        Median, in the parameter's unit.
    geometric_standard_deviation : float
        Factor above 1, within which of the median 68 % of draws lie: 1.1 is about ± 10 %.

    Examples
    --------
    >>> stress = il.Lognormal("345 MPa", 1.1)
    """

    median: Quantity
    geometric_standard_deviation: float


@dataclass(frozen=True)
class Triangular(_Distribution):
    """A density that rises from `low` to `mode` and falls to `high`.

    Parameters
    ----------
    low : Quantity
        Lower end, in the parameter's unit.
    mode : Quantity
        Most probable value, in the parameter's unit.
    high : Quantity
        Upper end, in the parameter's unit.

    Examples
    --------
    >>> stiffness = il.Triangular("190 GPa", "210 GPa", "230 GPa")
    """

    low: Quantity
    mode: Quantity
    high: Quantity


@dataclass(frozen=True)
class Choice(_Distribution):
    """One of several words, such as contact laws.

    For `Sobol`, `Delta` and `Pawn`, which need no order of the values.

    Parameters
    ----------
    values : sequence of str
        Two words or more.
    weights : sequence of float, optional
        Relative probability of each word, above zero; equal by default.

    Examples
    --------
    >>> law = il.Choice(["stronge", "mjg", "thornton"], weights=[2, 1, 1])
    """

    values: Sequence[str]
    weights: Sequence[float] | None = None


class _Sampling(_Section):
    _key = "method"


@dataclass(frozen=True, kw_only=True)
class Grid(_Sampling):
    """A grid: all combinations of the listed values are runs.

    Parameters
    ----------
    parameters : mapping of str to sequence of Quantity
        Values by name of the parameter (docs/studies.md lists the names).

    Examples
    --------
    >>> speeds = il.Grid(parameters={"velocity": ["50 cm/s", 1, 2], "contact": ["hertz", "mjg"]})
    """

    parameters: Mapping[str, Sequence[Quantity]]


@dataclass(frozen=True, kw_only=True)
class _Sample(_Sampling):
    parameters: Values
    seed: int | None = None

    def written(self) -> dict[str, Any]:
        """Return the section as a study file has it, with single values as fixed parameters.

        Returns
        -------
        dict
            Keys and values of the section.
        """
        section = super().written()
        if isinstance(self.parameters, Mapping):
            section["parameters"] = {
                name: item if isinstance(item, dict) else {"distribution": "fixed", "value": item}
                for name, item in section["parameters"].items()
            }
        return section


@dataclass(frozen=True, kw_only=True)
class Sobol(_Sample):
    """Saltelli's sample for Sobol indices of first, second and total order.

    D parameters take `base_samples` (2 D + 2) runs, without indices of second order
    `base_samples` (D + 2).

    Parameters
    ----------
    parameters : mapping of str to distribution or Quantity
        Distribution, or one fixed value, by name of the parameter.
    seed : int, default 1
        Equal seeds give equal runs.
    base_samples : int
        Number of base samples, a power of two, at least 4.
    second_order : bool, default True
        True to estimate indices of second order.
    groups : mapping of str to sequence of str, optional
        Parameters that get one index together, by name of the group.
    until : mapping, optional
        `{"interval": 0.05, "runs": 100_000}` doubles the sample until no interval is wider than
        ± `interval`, or the next sample would exceed `runs`.

    References
    ----------
    Saltelli et al. (2010), Comput. Phys. Commun. 181, 259, Table 2 (b) and (f); Saltelli (2002),
    Comput. Phys. Commun. 145, 280, Theorem 2.

    Examples
    --------
    >>> depth, stress = il.Uniform("26 mm", "29 mm"), il.Normal("345 MPa", "20 MPa")
    >>> sample = il.Sobol(
    ...     base_samples=1024, seed=1,
    ...     parameters={"beam_depth": depth, "beam_yield_stress": stress, "contact": "hertz"})
    """

    base_samples: int
    second_order: bool | None = None
    groups: Mapping[str, Sequence[str]] | None = None
    until: Values | None = None


@dataclass(frozen=True, kw_only=True)
class Morris(_Sample):
    """Trajectories for elementary effects: `trajectories` (D + 1) runs of D parameters.

    Parameters
    ----------
    parameters : mapping of str to distribution or Quantity
        Distribution, or one fixed value, by name of the parameter.
    seed : int, default 1
        Equal seeds give equal runs.
    trajectories : int
        Number of trajectories, at least 2.
    levels : int, default 4
        Number of levels of each parameter, even.
    groups : mapping of str to sequence of str, optional
        Parameters that get one index together, by name of the group.

    References
    ----------
    Morris (1991), Technometrics 33, 161.

    Examples
    --------
    >>> speed, depth = il.Uniform(1, 5), il.Uniform("26 mm", "29 mm")
    >>> sample = il.Morris(trajectories=20, parameters={"velocity": speed, "beam_depth": depth})
    """

    trajectories: int
    levels: int | None = None
    groups: Mapping[str, Sequence[str]] | None = None


@dataclass(frozen=True, kw_only=True)
class Fast(_Sample):
    """Search curves of extended FAST: at most `samples` (D + 1) runs of D parameters.

    Parameters
    ----------
    parameters : mapping of str to distribution or Quantity
        Distribution, or one fixed value, by name of the parameter.
    seed : int, default 1
        Equal seeds give equal runs.
    samples : int
        Number of runs per parameter; docs/studies.md has the least.
    harmonics : int, default 4
        Multiples of a parameter's frequency that are kept apart from other parameters.

    References
    ----------
    Saltelli et al. (1999), Technometrics 41, 39, eqs. 11 and 20.

    Examples
    --------
    >>> speed, depth = il.Uniform(1, 5), il.Uniform("26 mm", "29 mm")
    >>> sample = il.Fast(samples=1024, parameters={"velocity": speed, "beam_depth": depth})
    """

    samples: int
    harmonics: int | None = None


@dataclass(frozen=True, kw_only=True)
class _Latin(_Sample):
    samples: int
    correlations: Sequence[tuple[str, str, float]] | None = None


@dataclass(frozen=True, kw_only=True)
class Delta(_Latin):
    """A Latin hypercube for Borgonovo's delta.

    Parameters
    ----------
    parameters : mapping of str to distribution or Quantity
        Distribution, or one fixed value, by name of the parameter.
    seed : int, default 1
        Equal seeds give equal runs.
    samples : int
        Number of runs, at least 64.
    correlations : sequence of (str, str, float), optional
        Pairs of parameters with their rank correlation, `[("beam_depth", "velocity", 0.5)]`; other
        pairs are independent.

    References
    ----------
    Plischke et al. (2013), Eur. J. Oper. Res. 226, 536, eqs. 26 and 30.

    Examples
    --------
    >>> speed, depth = il.Uniform(1, 5), il.Uniform("26 mm", "29 mm")
    >>> sample = il.Delta(samples=128, parameters={"velocity": speed, "beam_depth": depth})
    """


@dataclass(frozen=True, kw_only=True)
class Pawn(_Latin):
    """A Latin hypercube for PAWN indices.

    Parameters
    ----------
    parameters : mapping of str to distribution or Quantity
        Distribution, or one fixed value, by name of the parameter.
    seed : int, default 1
        Equal seeds give equal runs.
    samples : int
        Number of runs, at least 100.
    correlations : sequence of (str, str, float), optional
        Pairs of parameters with their rank correlation, `[("beam_depth", "velocity", 0.5)]`; other
        pairs are independent.

    References
    ----------
    Pianosi and Wagener (2018), Environ. Model. Softw. 108, 197, eqs. 2 and 3.

    Examples
    --------
    >>> speed, depth = il.Uniform(1, 5), il.Uniform("26 mm", "29 mm")
    >>> sample = il.Pawn(samples=128, parameters={"velocity": speed, "beam_depth": depth})
    """


@dataclass(frozen=True, kw_only=True)
class Regression(_Latin):
    """A Latin hypercube for regression coefficients.

    Parameters
    ----------
    parameters : mapping of str to distribution or Quantity
        Distribution, or one fixed value, by name of the parameter.
    seed : int, default 1
        Equal seeds give equal runs.
    samples : int
        Number of runs, at least 64.
    correlations : sequence of (str, str, float), optional
        Pairs of parameters with their rank correlation, `[("beam_depth", "velocity", 0.5)]`; other
        pairs are independent.

    References
    ----------
    Saltelli et al. (2008), Global Sensitivity Analysis: The Primer, section 1.2.5.

    Examples
    --------
    >>> speed, depth = il.Uniform(1, 5), il.Uniform("26 mm", "29 mm")
    >>> sample = il.Regression(samples=128, parameters={"velocity": speed, "beam_depth": depth})
    """


def plain(value: Any) -> Any:
    """Return numbers, text, lists and mappings in place of any other value."""
    if isinstance(value, _Section):
        return value.written()
    if isinstance(value, Impact):
        return _stated(value, Discretisation(), "impact")
    if isinstance(value, Discretisation):
        return _stated(paper_impact(), value, "discretisation")
    if isinstance(value, np.ndarray | np.generic):
        return value.tolist()
    if isinstance(value, Mapping):
        return {key: plain(item) for key, item in value.items()}
    if isinstance(value, list | tuple | set):
        return [plain(item) for item in value]
    if not isinstance(text := as_text(value), str | int | float | list | None):
        raise ValueError(f"is of type {type(value).__name__}, which no study file can hold")
    return text


def _stated(impact: Impact, grid: Discretisation, root: str) -> dict[str, Any]:
    """Return every value as a section of a study file: defaults, too, which may change."""
    section: dict[str, Any] = {}
    for name, value in flatten(impact, grid).items():
        key, *path = PARAMETERS[name].path
        if key == root:
            node = section
            for step in path[:-1]:
                node = node.setdefault(step, {})
            node[path[-1]] = value
    return section


def text_of(sections: Values) -> str:
    """Return the text of a study file with these sections; those that are None are left out.

    Raises StudyError naming a section that no file can hold.
    """
    content: dict[str, Any] = {}
    for key, section in sections.items():
        try:
            content |= {} if section is None else {key: plain(section)}
        except ValueError as error:
            raise StudyError(Problem("Study", key, str(error))) from None
    yaml: Any = YAML(typ="safe", pure=True)
    text = io.StringIO()
    yaml.default_flow_style, yaml.sort_base_mapping_type_on_output = None, False
    yaml.width, yaml.allow_unicode = 96, True
    yaml.dump(content, text)
    return text.getvalue()
