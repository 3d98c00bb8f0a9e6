"""One impact on the paper's beam."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from impactlab.cli.options import given


def simulate(
    velocity: Annotated[
        str, typer.Option(help="Impact velocity, such as 0.99 or '99 cm/s'.")
    ] = "0.99",
    contact: Annotated[str, typer.Option(help="Contact law.")] = "stronge",
    beam_model: Annotated[
        str, typer.Option(help="euler_bernoulli, elastic, timoshenko, spring_mass or rigid.")
    ] = "euler_bernoulli",
    nodes: Annotated[int, typer.Option(help="Nodes along the span, odd.")] = 601,
    points: Annotated[int, typer.Option(help="Integration points over the depth.")] = 9,
    rule: Annotated[str, typer.Option(help="lobatto, legendre or layers.")] = "lobatto",
    scheme: Annotated[
        str, typer.Option(help="leapfrog or semi_implicit, which pays from about 601 nodes on.")
    ] = "leapfrog",
    duration: Annotated[str, typer.Option(help="Simulated time, such as '1 ms'.")] = "1 ms",
    output: Annotated[
        Path | None, typer.Option(help="Keep histories and fields as netCDF.")
    ] = None,
) -> None:
    """Solve one impact on the paper's beam and print its responses."""
    from dataclasses import replace

    from impactlab.model.discretisation import Discretisation
    from impactlab.model.impact import paper_impact
    from impactlab.report.console import print_responses

    impact = paper_impact(given("--velocity", velocity, "m s-1"), contact)
    impact = replace(impact, beam_model=beam_model)
    grid = Discretisation(nodes=nodes, points=points, rule=rule, scheme=scheme)
    seconds = given("--duration", duration, "s")
    if output is None:
        from impactlab.simulate import case_table, solve

        print_responses(solve(case_table(impact, grid, duration=seconds)).responses[0])
    else:
        from impactlab.simulate import simulate as solve_one
        from impactlab.study.netcdf import write_netcdf

        dataset = solve_one(impact, grid, duration=seconds)
        print_responses(dataset)
        write_netcdf(dataset, output)
