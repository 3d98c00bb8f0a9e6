"""Stored surrogates: surrogate.nc, and predictions from it within the ranges of its runs."""

import json
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from impactlab.analysis.surrogate.chaos import basis, orthonormal
from impactlab.analysis.surrogate.from_runs import SurrogateVerdict, half_width
from impactlab.files import read_netcdf
from impactlab.methods.distributions import distribution_of
from impactlab.model.checks import did_you_mean
from impactlab.model.quantities import engineering, misread
from impactlab.types import Floats
from impactlab.verdicts import names

IMPRECISE = 0.1
"""Error, relative to a prediction, from which on that prediction is imprecise."""
FORMAT = 2
"""Of surrogate.nc: 1 had polynomials in probabilities, which bend at the ends of ranges."""
_AT_ONCE = 4096  # number of points whose terms about fit in the processor's cache


class Surrogate:
    """The surrogates of all responses of one study (see `il.load_surrogate`).

    Parameters
    ----------
    dataset : xarray.Dataset
        Dataset of surrogate.nc.

    Attributes
    ----------
    parameters : tuple of str
        Names of the varied parameters.
    responses : tuple of str
        Names of the responses.
    """

    def __init__(self, dataset: xr.Dataset) -> None:
        """Take the dataset of surrogate.nc (see `packed`)."""
        self.dataset = dataset
        self.parameters: tuple[str, ...] = tuple(map(str, dataset["parameter"].values))
        self.responses: tuple[str, ...] = tuple(map(str, dataset["response"].values))
        self._distributions = [
            distribution_of(json.loads(text)) for text in dataset["distribution"].values
        ]
        self._polynomials = [orthonormal(distribution) for distribution in self._distributions]
        self._study = repr(dataset.attrs.get("study", "?"))
        self._takes = f"the surrogate takes {', '.join(self.parameters)}"

    def units(self, parameter: str) -> str:
        """Return the SI unit of a parameter.

        Parameters
        ----------
        parameter : str
            Name of the parameter.

        Returns
        -------
        str
            Unit in UDUNITS spelling.

        Raises
        ------
        ValueError
            If the parameter was not varied.
        """
        self._check_known(parameter)
        return str(self.dataset["parameter_units"].sel(parameter=parameter).item())

    def predict(self, **values: Any) -> xr.Dataset:
        """Predict every response at values of all varied parameters.

        Parameters
        ----------
        **values : float, array_like or xarray.DataArray
            Value of each varied parameter by name, in SI units: numbers, arrays of shape (point,),
            or DataArrays, which are broadcast against each other.

        Returns
        -------
        xarray.Dataset
            Responses on the common dimensions, NaN where there is no surrogate, with the values as
            coordinates. Attributes of each response: units, long_name; rmse and q2, of runs left
            out; error, the half-width of the 95 % interval of a prediction, and leverage, how far
            out the point is, both the largest over the points; and verdict, that of the surrogate,
            or, where this is "usable": "extrapolated" where a point lies farther out than every run
            tested on, so that no run bears out its error; "imprecise" where a prediction is smaller
            than ten times its error.

        Raises
        ------
        ValueError
            If a value is missing, was not varied, or lies outside the range of the surrogate; the
            message names parameter, value and range.
        """
        for name in values:
            self._check_known(name)
        if absent := [name for name in self.parameters if name not in values]:
            raise ValueError(f"{', '.join(absent)}: no value is given; {self._takes}")
        arrays = [self._checked(name, values[name]) for name in self.parameters]
        columns = [
            array.drop_vars(self.parameters, errors="ignore") for array in xr.broadcast(*arrays)
        ]
        inputs = np.column_stack([column.values.ravel() for column in columns])
        answers, leverages, errors = self._evaluated(inputs)
        variables = {}
        for position, name in enumerate(self.responses):
            entry = self.dataset.sel(response=name)
            verdict = names(SurrogateVerdict)[int(entry["verdict"])]
            if verdict == "usable":
                if (leverages[position] > float(entry["reach"])).any():
                    verdict = "extrapolated"
                elif (errors[position] > IMPRECISE * np.abs(answers[position])).any():
                    verdict = "imprecise"
            attrs = {
                "long_name": str(entry["response_long_name"].item()),
                "units": str(entry["response_units"].item()),
                "rmse": float(entry["rmse"]),
                "error": float(errors[position].max(initial=0.0)),
                "leverage": float(leverages[position].max(initial=0.0)),
                "q2": float(entry["q2"]),
                "verdict": verdict,
            }
            variables[name] = (columns[0].dims, answers[position].reshape(columns[0].shape), attrs)
        return xr.Dataset(variables, dict(zip(self.parameters, columns, strict=True)))

    def at(self, unit: Floats) -> Floats:
        """Return all responses where the parameters have these probabilities.

        Parameters
        ----------
        unit : numpy.ndarray
            Probabilities in [0, 1], shape (points, parameters).

        Returns
        -------
        numpy.ndarray
            Responses in SI units, shape (responses, points).
        """
        return self._evaluated(self._inputs(unit))[0]

    def errors(self, unit: Floats) -> Floats:
        """Return half-widths of the 95 % intervals of `at`.

        Parameters
        ----------
        unit : numpy.ndarray
            Probabilities in [0, 1], shape (points, parameters).

        Returns
        -------
        numpy.ndarray
            Half-widths in SI units, shape (responses, points).
        """
        return self._evaluated(self._inputs(unit))[2]

    def _inputs(self, unit: Floats) -> Floats:
        pairs = zip(self._distributions, unit.T, strict=True)
        return np.column_stack([distribution.quantile(column) for distribution, column in pairs])

    def _evaluated(self, inputs: Floats) -> tuple[Floats, Floats, Floats]:
        """Return responses, leverages and errors at points in SI units, each (responses, points).

        Leverages are those of each response's terms (see `validation.leverage`).
        """
        degrees, coefficients = self.dataset["degree"].values, self.dataset["coefficient"].values
        shares = (coefficients != 0) / np.maximum((coefficients != 0).sum(axis=1), 1)[:, np.newaxis]
        answers, leverages = [], []
        for start in range(0, len(inputs) or 1, _AT_ONCE):
            columns = basis(inputs[start : start + _AT_ONCE], degrees, self._polynomials)
            answers.append(coefficients @ columns)
            leverages.append(shares @ columns**2)
        leverage = np.hstack(leverages)
        scale, growth = (self.dataset[n].values[:, np.newaxis] for n in ("error", "error_growth"))
        return np.hstack(answers), leverage, half_width(leverage, scale, growth)

    def distribution(self, parameter: str) -> dict[str, Any]:
        """Return the distribution of a parameter.

        Parameters
        ----------
        parameter : str
            Name of a varied parameter.

        Returns
        -------
        dict
            Name and arguments of the distribution, in SI units.
        """
        return self._distributions[self.parameters.index(parameter)].arguments()

    def probability(self, parameter: str, value: float) -> float:
        """Return the probability of smaller values.

        Parameters
        ----------
        parameter : str
            Name of a varied parameter.
        value : float
            Value of the parameter, in SI units.

        Returns
        -------
        float
            Cumulative probability, in [0, 1].

        Raises
        ------
        ValueError
            If the value lies outside the sampled range.
        """
        self._checked(parameter, value)
        return float(self._distributions[self.parameters.index(parameter)].cumulative(value))

    def _check_known(self, name: str) -> None:
        if name not in self.parameters:
            held = self.dataset.coords.get(name)
            remark = "" if held is None else f" (it is {held.item()!r} in all of its runs)"
            near = did_you_mean(name, self.parameters)
            raise ValueError(
                f"{name}: was not varied in study {self._study}{remark}{near or ';'} {self._takes}"
            )

    def _checked(self, name: str, value: Any) -> xr.DataArray:
        """Return a parameter's values as floats. Raises ValueError where it cannot take one."""
        labelled = isinstance(value, xr.DataArray)
        try:
            array: Any = value.astype(float) if labelled else np.asarray(value, dtype=float)
        except (TypeError, ValueError):
            raise ValueError(f"{name} = {value!r}: expected numbers in SI units") from None
        if not labelled and array.ndim > 1:
            raise ValueError(
                f"{name}: has {array.ndim} dimensions: give a number, a list, or a DataArray"
            )
        entry = self.dataset.sel(parameter=name)
        low, high = float(entry["lowest"]), float(entry["highest"])
        numbers = np.asarray(array)
        outside = ~((numbers >= low) & (numbers <= high))
        if outside.any():
            ends = float(numbers[outside][0]), low, high
            units = self.units(name)
            worst, least, most = (engineering(end, units, 6) for end in ends)
            raise ValueError(
                f"{name}: {worst} is outside {least} to {most}, where the "
                f"surrogate of study {self._study} was trained: choose a value within, or "
                f"sample a wider range{misread(ends[0], units, low, high)}"
            )
        return array if labelled else xr.DataArray(array, dims=("point",)[: array.ndim])


def packed(runs: xr.Dataset, analysis: xr.Dataset) -> xr.Dataset | None:
    """Return the surrogates of a sample as a dataset; None where the analysis has none.

    Variables, without the prefix that they have in `analysis`: coefficient (response, term),
    degree (term, parameter), verdict, q2, q2_low, rmse, error, error_growth, reach and runs
    (response); on (parameter): distribution
    (its name and arguments as JSON, in SI units), lowest and highest (between which it was
    trained: its bounds, or the extreme draws), parameter_units, parameter_long_name. Parameters
    that were not varied are scalar coordinates, as in the runs; so are the attributes. Raises
    ValueError for an analysis with the polynomials of an earlier version.
    """
    if "surrogate_coefficient" not in analysis:
        return None
    if "surrogate_error" not in analysis:
        raise ValueError(_EARLIER.format("the analysis"))
    fields = ("coefficient", "degree", "verdict", "q2", "q2_low", "rmse", "error", "error_growth")
    renamed = {f"surrogate_{name}": name for name in (*fields, "reach", "runs")}
    dataset = analysis[list(renamed)].drop_vars("parameter", errors="ignore")
    dataset = dataset.rename(renamed | {"surrogate_term": "term", "surrogate_input": "parameter"})
    columns = [runs[str(name)] for name in dataset["parameter"].values]
    distributions = [distribution_of(column.attrs).arguments() for column in columns]
    pairs = list(zip(distributions, columns, strict=True))
    lowest = [entry.get("low", float(column.min())) for entry, column in pairs]
    highest = [entry.get("high", float(column.max())) for entry, column in pairs]
    inputs = {
        "distribution": ([json.dumps(distribution) for distribution in distributions], {}),
        "parameter_units": ([column.attrs.get("units", "1") for column in columns], {}),
        "parameter_long_name": ([column.attrs.get("long_name", "") for column in columns], {}),
        "lowest": (lowest, {"long_name": "lowest value trained on, SI"}),
        "highest": (highest, {"long_name": "highest value trained on, SI"}),
    }
    reserved = {*dataset.variables, *dataset.dims, *inputs}  # a function may use such names
    held = {n: array for n, array in runs.coords.items() if array.ndim == 0 and n not in reserved}
    return (
        dataset.assign({name: ("parameter", *entry) for name, entry in inputs.items()})
        .assign_coords(held)
        .assign_attrs(runs.attrs, surrogate_format=FORMAT)
    )


_EARLIER = (
    "{}: its surrogates are those of an earlier version, whose polynomials bend at the ends of "
    "ranges: make it again with `impactlab analyse`"
)


def load_surrogate(path: str | Path) -> Surrogate:
    """Load the surrogates of a study.

    Parameters
    ----------
    path : str or pathlib.Path
        File surrogate.nc of the study's folder, which `il.Study.analyse` writes for a sample.

    Returns
    -------
    Surrogate
        Predictions of every response.

    Raises
    ------
    OSError
        If there is no such file, or it cannot be read.
    ValueError
        If the file holds no surrogate, or one of an earlier version.

    References
    ----------
    Blatman and Sudret (2011), J. Comput. Phys. 230, 2345, section 4.3; Sudret (2008), Reliab. Eng.
    Syst. Saf. 93, 964, eqs. 36 to 39.

    Examples
    --------
    >>> study = il.Study(
    ...     title="Ishigami", function="ishigami", sampling=il.Sobol(base_samples=256, parameters={
    ...         name: il.Uniform("-3.14", "3.14") for name in ("x1", "x2", "x3")}))
    >>> runs, analysis = study.run(workers=1), study.analyse()
    >>> surrogate = il.load_surrogate(study.folder / "surrogate.nc")
    >>> surrogate.predict(x1=1.0, x2=0.5, x3=0.0).value.round(1).item()
    2.5
    """
    if not Path(path).exists():
        raise FileNotFoundError(
            f"{path}: there is no such file: `impactlab analyse` writes it for a sample, unless "
            "words are drawn, over which no surrogate is fitted"
        )
    dataset = read_netcdf(Path(path), "surrogate")
    if dataset.attrs.get("surrogate_format") != FORMAT:
        raise ValueError(_EARLIER.format(path))
    return Surrogate(dataset)
