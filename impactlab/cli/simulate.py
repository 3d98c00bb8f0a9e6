"""One impact on the paper's beam."""

from __future__ import annotations

import logging
import warnings
from collections.abc import Mapping
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from impactlab import wings
from impactlab.cli.options import assigned, given, new_file

if TYPE_CHECKING:
    from impactlab.model.discretisation import Discretisation
    from impactlab.model.impact import Impact
    from impactlab.model.parameters import Value


def simulate(
    velocity: Annotated[
        str, typer.Option(help="Impact velocity, such as 0.99 or '99 cm/s'.")
    ] = "0.99",
    base: Annotated[
        str, typer.Option(help="paper, or corrected: the beam model nearest to 3-D results.")
    ] = "paper",
    contact: Annotated[str | None, typer.Option(help="Contact law, if not the base's.")] = None,
    beam_model: Annotated[
        str | None,
        typer.Option(
            help="euler_bernoulli, elastic, timoshenko, von_karman, spring_mass or rigid, "
            "if not the base's."
        ),
    ] = None,
    nodes: Annotated[int, typer.Option(help="Nodes along the span, odd.")] = 201,
    points: Annotated[int, typer.Option(help="Integration points over the depth.")] = 9,
    rule: Annotated[str, typer.Option(help="lobatto, legendre or layers.")] = "lobatto",
    scheme: Annotated[
        str, typer.Option(help="leapfrog, modal (the same from far fewer nodes) or auto.")
    ] = "leapfrog",
    settings: Annotated[
        list[str] | None,
        typer.Option(
            "--set",
            metavar="NAME=VALUE",
            help="Any parameter of a study, such as beam_depth='20 mm'; can be repeated.",
        ),
    ] = None,
    duration: Annotated[str, typer.Option(help="Simulated time, such as '1 ms'.")] = "6 ms",
    output: Annotated[
        Path | None, new_file(".nc", help="Write histories and fields to this netCDF file.")
    ] = None,
    plot: Annotated[
        Path | None,
        new_file(
            ".png", ".svg", ".pdf", help="Draw force, motion and strain: a PNG, SVG or PDF file."
        ),
    ] = None,
) -> None:
    """Solve one impact, on any beam, and print its responses."""
    from impactlab.report.console import print_responses

    texts = {"velocity": velocity, "duration": duration, "rule": rule, "scheme": scheme}
    texts |= {"contact": contact} if contact else {}
    texts |= {"beam_model": beam_model} if beam_model else {}
    values: dict[str, Value] = {"nodes": nodes, "points": points}
    values |= _read({name: (_option(name), text) for name, text in texts.items()})
    values |= _settings(settings or [])
    seconds = float(values.pop("duration"))
    impact, grid = _checked(base, values)
    from impactlab.model.case_table import case_table
    from impactlab.simulate import simulate as solve_one
    from impactlab.solve import solve, too_short

    cases = case_table(impact, grid, duration=seconds)
    answers: Any
    if output is None and plot is None:
        answers = solve(cases)
    else:
        with warnings.catch_warnings():  # said by _checked, and below
            warnings.simplefilter("ignore")
            answers = dataset = solve_one(impact, grid, duration=seconds)
    print_responses(answers)
    if message := too_short(cases, answers["status"]):
        print(f"--{message}.")
    if output:
        from impactlab.files import write_netcdf

        write_netcdf(dataset, output, "impact")
        print(f"Histories and fields: {output}")
    if plot:
        from impactlab.figures.single_runs import save_picture

        save_picture(dataset, plot)
        print(f"Picture: {plot}")


def _settings(arguments: list[str]) -> dict[str, Value]:
    """Return the parameters of `--set`, in SI units. Raises ValueError naming the one at fault."""
    from impactlab.model.parameters import PARAMETERS
    from impactlab.validation.errors import unknown

    names = [name for name in PARAMETERS if name not in wings.sizes()]
    texts = assigned(arguments)
    for name in texts:
        if name not in names:
            raise ValueError(f"--set {name}: {unknown('parameter', name, names)}")
    return _read({name: (f"--set {name}", text) for name, text in texts.items()})


def _read(stated: Mapping[str, tuple[str, str]]) -> dict[str, Value]:
    """Return values in SI units, by parameter; stated: option and text of each.

    Raises ValueError naming the option at fault, and the one that its text is for, if any.
    """
    values = {}
    for name, (option, text) in stated.items():
        try:
            values[name] = _value(name, option, text)
        except ValueError as error:
            raise ValueError(f"{error}{_exchanged(name, stated)}") from None
    return values


def _value(name: str, option: str, text: str) -> Value:
    """Return a parameter's value, or the duration. Raises ValueError naming the option."""
    from impactlab.model.parameters import PARAMETERS
    from impactlab.model.quantities import whole
    from impactlab.validation.errors import unknown

    if name == "duration":
        return given(option, text, "s")
    parameter = PARAMETERS[name]
    if parameter.any_word:
        return text
    if not parameter.choices and not parameter.is_integer:
        return given(option, text, parameter.units)
    try:
        if parameter.is_integer:
            return whole(text)
    except ValueError as error:
        raise ValueError(f"{option} = {text!r}: {error}") from None
    choices = (*parameter.choices, *(["auto"] if name == "scheme" else []))
    if text not in choices:
        raise ValueError(f"{option} = {text!r}: {unknown(parameter.long_name, text, choices)}")
    return text


def _exchanged(name: str, stated: Mapping[str, tuple[str, str]]) -> str:
    """Return a remark on the option that the text of a parameter is for; "" where there is none."""
    option, text = stated[name]
    for other, (place, its) in stated.items():
        with suppress(ValueError):
            _value(other, place, text)
            with suppress(ValueError):
                _value(name, option, its)
                return f"; {option} and {place} are swapped"
            return f"; {text!r} is a value for {place}"
    return ""


def _option(name: str) -> str:
    """Return the option that states a parameter."""
    options = ("velocity", "contact", "beam_model", "nodes", "points", "rule", "scheme", "duration")
    return f"--{name.replace('_', '-')}" if name in options else f"--set {name}"


def _checked(base: str, values: dict[str, Value]) -> tuple[Impact, Discretisation]:
    """Return the base with these values, and log warnings of implausible ones.

    Raises ValueError naming the option that the model refuses, or whose value is impossible.
    """
    from impactlab.model.discretisation import Discretisation
    from impactlab.model.impact import BASES
    from impactlab.model.parameters import PARAMETERS, with_values
    from impactlab.model.plausibility import implausibilities, numbers
    from impactlab.model.quantities import shown
    from impactlab.validation.errors import unknown
    from impactlab.validation.refusals import refusal

    if base not in BASES:
        raise ValueError(f"--base = {base!r}: {unknown('base', base, BASES)}")
    start = BASES[base](), Discretisation()
    if refused := refusal(start, values):
        stated, units = f"{refused.name} of the base {base!r}", PARAMETERS[refused.name].units
        if refused.name in values:
            stated = shown(_option(refused.name), values[refused.name], units)
        for other in values if refused.name in values and units != "1" else ():
            pair = {refused.name: values[other], other: values[refused.name]}
            if PARAMETERS[other].units == units and not refusal(start, values | pair):
                stated = f"{_option(refused.name)} and {_option(other)} are swapped: {stated}"
        raise ValueError(f"{stated}: {refused.reason}")
    case = with_values(*start, values)
    for doubt in implausibilities(numbers(*case)):
        if doubt.impossible:
            raise ValueError(f"{_option(doubt.name)}: {doubt.reason}")
        logging.getLogger("impactlab").warning("%s: %s", _option(doubt.name), doubt.reason)
    return case


def compile_kernels(
    further: Annotated[
        bool,
        typer.Option("--wings", help="Compile those of several spheres and of the 3-D model, too."),
    ] = False,
) -> None:
    """Compile the kernels of the beam models into their cache.

    For images of containers, and for clusters before their jobs begin: without it, the first
    impact compiles. NUMBA_CACHE_DIR names another folder.
    """
    from impactlab.solve import compile_kernels

    models = wings.models().values() if further else ()
    folders = [compile_kernels(several=(False, True) if further else (False,))]
    folders += [model.part("compile")() for model in models]
    for folder in folders:
        print(f"Compiled kernels: {folder}" if folder else "Compiled kernels cannot be kept.")
