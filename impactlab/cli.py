"""The command line: parses, calls, prints. Heavy imports wait until a command needs them."""

from __future__ import annotations

import gc
import logging
import os
import signal
import sys
from pathlib import Path
from typing import Annotated

import typer

app = typer.Typer(
    name="impactlab",
    help="A sphere strikes an elastic-plastic beam: from a study file to a report.",
    no_args_is_help=True,
    pretty_exceptions_enable=False,
    rich_markup_mode=None,  # plain help: boxes and colours take twice as long
    add_completion=False,
)

StudyFile = Annotated[
    Path, typer.Argument(metavar="STUDY", help="A study file, studies/NAME.yaml.")
]
RunsFile = Annotated[
    Path, typer.Argument(metavar="RUNS", help="Solved runs, results/NAME/runs.nc.")
]
StoredFiles = Annotated[
    list[Path],
    typer.Argument(
        metavar="STORED...",
        help="Of a study: runs.nc and analysis.nc. Of a verification: findings.nc.",
    ),
]
RESULTS = Path("results")


def main() -> None:
    """Run the command line; a user's mistake ends in one message and exit code 1."""
    gc.set_threshold(100_000)  # loading modules makes many objects, but no rubbish
    try:
        app()
    except KeyboardInterrupt:
        print("impactlab: interrupted", file=sys.stderr)
        sys.exit(130)
    except (ValueError, OSError) as error:
        logger = logging.getLogger("impactlab")
        logger.error("%s", error)
        logger.debug("it came from here", exc_info=True)
        sys.exit(1)


@app.callback()
def configure(
    log: Annotated[Path | None, typer.Option(help="Write messages to this file as well.")] = None,
    debug: Annotated[
        bool, typer.Option(help="Log details, the place of an error included.")
    ] = False,
) -> None:
    """Set up logging for every command."""
    logger = logging.getLogger("impactlab")
    logger.setLevel(logging.DEBUG if debug else logging.INFO)
    handlers: list[logging.Handler] = [logging.StreamHandler()]
    if log:
        log.parent.mkdir(parents=True, exist_ok=True)
        handlers.append(logging.FileHandler(log, mode="w"))
    logger.handlers[:] = handlers
    for handler in handlers:
        handler.setFormatter(logging.Formatter("%(levelname)s: %(message)s"))


@app.command()
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
    from impactlab.model.paper import paper_impact
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


@app.command()
def studies(
    folder: Annotated[Path, typer.Argument(help="Where the study files lie.")] = Path("studies"),
) -> None:
    """List a folder's studies with their number of runs or checks."""
    from impactlab.report.console import print_studies
    from impactlab.study.declaration import read_any

    files = sorted(folder.glob("*.yaml"))
    if not files:
        raise FileNotFoundError(f"{folder}: no study files (*.yaml) there")
    read = [read_any(path) for path in files]
    print_studies((study.name, study.size, study.title) for study in read)


@app.command()
def design(
    study: StudyFile,
    output: Annotated[Path | None, typer.Option(help="Default: results/NAME/design.nc.")] = None,
) -> None:
    """Sample a study into its runs."""
    from impactlab.study.declaration import read_study
    from impactlab.study.netcdf import write_netcdf
    from impactlab.study.sampling import design as sampled

    write_netcdf(sampled(read_study(study)), output or RESULTS / study.stem / "design.nc")


@app.command()
def run(
    design_file: Annotated[
        Path, typer.Argument(metavar="STUDY", help="A study file, or its design.nc.")
    ],
    output: Annotated[Path | None, typer.Option(help="Default: results/NAME/runs.nc.")] = None,
    workers: Annotated[int, typer.Option(min=1, help="Threads or processes.")] = os.cpu_count()
    or 1,
    processes: Annotated[bool, typer.Option("--processes", help="Processes, not threads.")] = False,
    scheduler: Annotated[str, typer.Option(help="Address of a running dask scheduler.")] = "",
) -> None:
    """Solve the runs of a study that have not been solved yet.

    Finished batches are kept in results/NAME/shards: an interrupted study goes on from there.
    """
    from impactlab.study.declaration import read_study
    from impactlab.study.engine import Engine
    from impactlab.study.execution import execute
    from impactlab.study.netcdf import read_netcdf, write_netcdf
    from impactlab.study.sampling import design as sampled

    if design_file.suffix == ".nc":
        samples = read_netcdf(design_file)
    else:
        samples = sampled(read_study(design_file))
    path = output or RESULTS / samples.attrs["study"] / "runs.nc"
    engine = Engine("processes" if processes else "threads", workers, scheduler)
    signal.signal(signal.SIGINT, _stop_at_once)
    write_netcdf(execute(samples, path.parent / "shards", engine), path)


@app.command()
def analyse(
    runs: RunsFile,
    output: Annotated[Path | None, typer.Option(help="Default: beside the runs.")] = None,
) -> None:
    """Convergence and sensitivity from solved runs; surrogates.

    The surrogates of a sample lie in surrogate.nc beside the analysis: see `impactlab predict`.
    """
    from impactlab.analysis.analyse import analyse as analysed
    from impactlab.analysis.surrogate import packed
    from impactlab.study.netcdf import read_netcdf, write_netcdf

    solved, path = read_netcdf(runs), output or runs.with_name("analysis.nc")
    found = analysed(solved)
    write_netcdf(found, path)
    if surrogates := packed(solved, found):
        write_netcdf(surrogates, path.with_name("surrogate.nc"))
    else:
        path.with_name("surrogate.nc").unlink(missing_ok=True)


@app.command()
def predict(
    surrogate: Annotated[
        Path, typer.Argument(metavar="SURROGATE", help="results/NAME/surrogate.nc.")
    ],
    values: Annotated[
        list[str],
        typer.Argument(metavar="NAME=VALUE...", help="Such as velocity=2 beam_depth='27 mm'."),
    ],
) -> None:
    """Predict the responses of one run without solving it.

    All parameters that the study varied have to be given. Beside each response stands the
    surrogate's error on runs that it was not fitted to.
    """
    from impactlab.analysis.surrogate import load_surrogate
    from impactlab.report.console import print_predictions

    model = load_surrogate(surrogate)
    texts = assigned(values)
    numbers = {name: given(name, text, model.units(name)) for name, text in texts.items()}
    print_predictions(model.predict(**numbers))


@app.command()
def verify(
    study: Annotated[
        Path, typer.Argument(metavar="STUDY", help="A study file of checks, or its findings.nc.")
    ],
    output: Annotated[Path | None, typer.Option(help="Default: results/NAME/findings.nc.")] = None,
    exit_zero: Annotated[
        bool,
        typer.Option("--exit-zero", help="End with exit code 0 although a check fails."),
    ] = False,
) -> None:
    """Hold the solver against independent solutions.

    Exit code 1 where a check fails; what was found is written all the same. Of a findings.nc the
    verdict is told again.
    """
    from impactlab.report.console import print_outcomes
    from impactlab.study.checking import check, failure
    from impactlab.study.declaration import read_verification
    from impactlab.study.netcdf import read_netcdf, write_netcdf
    from impactlab.verification.stored import unpacked

    if study.suffix == ".nc":
        findings = read_netcdf(study)
    else:
        findings = check(read_verification(study))
        write_netcdf(findings, output or RESULTS / study.stem / "findings.nc")
    outcomes = unpacked(findings)
    print_outcomes(outcomes)
    if said := failure(outcomes):
        logging.getLogger("impactlab").error("%s", said)
        raise typer.Exit(code=0 if exit_zero else 1)


@app.command()
def figures(
    stored: StoredFiles,
    output: Annotated[
        Path | None, typer.Option(help="Default: figures/ beside the first of them.")
    ] = None,
) -> None:
    """Draw every figure that a study's answers, or findings, allow."""
    from impactlab.report.kinds import read_stored

    kind, datasets = read_stored(stored)
    kind.draw(datasets, output or stored[0].with_name("figures"))


@app.command()
def report(
    stored: StoredFiles,
    figures: Annotated[
        Path | None, typer.Option(help="Default: figures/ beside the first of them.")
    ] = None,
    output: Annotated[
        Path | None, typer.Option(help="Default: report.html beside the first of them.")
    ] = None,
) -> None:
    """Write a study's report."""
    from impactlab.report.kinds import read_stored

    kind, datasets = read_stored(stored)
    kind.write(
        datasets,
        figures or stored[0].with_name("figures"),
        output or stored[0].with_name("report.html"),
    )


@app.command()
def paper(
    folders: Annotated[
        list[Path],
        typer.Argument(metavar="RESULTS...", help="results/NAME of each study of the paper."),
    ],
    output: Annotated[Path, typer.Option(help="A folder.")] = RESULTS / "paper",
) -> None:
    """Answer the paper: its figures, its statements tested.

    A study that is not there leaves its figures out, and its statements unjudged.
    """
    from impactlab.report.paper import read_solved, write_paper

    write_paper(read_solved(folders), output)


@app.command()
def index(
    results: Annotated[Path, typer.Argument(help="Folder of results.")] = RESULTS,
    output: Annotated[Path | None, typer.Option(help="Default: index.html in it.")] = None,
) -> None:
    """Write the index over all reports."""
    from impactlab.report.index import write_index

    write_index(results, output or results / "index.html")


def given(option: str, text: str, units: str) -> float:
    """An option's quantity in SI; raises ValueError naming the option."""
    from impactlab.study.quantities import si

    try:
        return si(text, units)
    except ValueError as error:
        raise ValueError(f"{option} = {text!r}: {error}") from None


def assigned(arguments: list[str]) -> dict[str, str]:
    """Arguments NAME=VALUE by name; raises ValueError for any other, and for a name given twice."""
    found: dict[str, str] = {}
    for argument in arguments:
        name, sign, text = argument.partition("=")
        if not sign or not text:
            raise ValueError(f"{argument!r}: expected NAME=VALUE, such as velocity=2")
        if name in found:
            raise ValueError(f"{name}: is given twice, as {found[name]!r} and as {text!r}")
        found[name] = text
    return found


def _stop_at_once(number: int, frame: object) -> None:
    """End on Ctrl-C: finished batches are on disk, and dask's own clean-up may hang in between."""
    show_cursor = "\x1b[?25h\n" if sys.stderr.isatty() else ""
    message = f"{show_cursor}impactlab: interrupted; the same command goes on from here\n"
    os.write(sys.stderr.fileno(), message.encode())
    os._exit(130)
