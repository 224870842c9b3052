"""The command `railslide`. Everything heavy is imported by the verb that needs it, so that help is there at once."""

import gc
import os
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from scenarios.compile_cache import use_compile_cache
from scenarios.errors import BadInput, RunFailed, RunInterrupted
from scenarios.interruption import Interruption

if TYPE_CHECKING:
    from scenarios.schema import Scenario

FAILED, BAD_INPUT, SIGNALLED = 1, 2, 128

ScenarioArgument = Annotated[str, typer.Argument(help="Name of a built-in scenario, or a path to a .toml file.")]
Settings = Annotated[list[str] | None, typer.Option("--set", metavar="KEY=VALUE", help="Override a key, as in run.")]

app = typer.Typer(
    help="A coach brakes on slippery rail: wheel slide protection, sensors and estimators under one roof.",
    no_args_is_help=True,
    add_completion=False,
    rich_markup_mode=None,  # the decorated help takes twice as long to come up
    pretty_exceptions_enable=False,
)


def main() -> None:
    """Entry point of the command."""
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")  # small matrices: threads cost more than they give
    gc.set_threshold(100_000, 20, 20)  # most of what is made lives on; looking for garbage takes a tenth of a run
    app()


@app.callback(invoke_without_command=True)
def common(
    version: Annotated[bool, typer.Option("--version", help="Show the version and exit.")] = False,
) -> None:
    if version:
        from importlib.metadata import version as version_of

        typer.echo(f"railslide {version_of('railslide')}")
        raise typer.Exit


@app.command()
def run(
    scenario: ScenarioArgument,
    settings: Annotated[
        list[str] | None,
        typer.Option(
            "--set",
            metavar="KEY=VALUE",
            help="Override a key, as in --set wsp.controller=none; may be repeated. scenario.seed sets both seeds.",
        ),
    ] = None,
    out: Annotated[
        Path,
        typer.Option(
            help="Where the run folder is made, called after scenario.name; an older run of that name is replaced."
        ),
    ] = Path("runs"),
    figures: Annotated[bool, typer.Option(help="Draw the figures.")] = True,
) -> None:
    """Run a scenario and write its run folder."""
    with _exit_codes() as interruption:
        compiles = not any(use_compile_cache().rglob("*.nbi"))
        from scenarios.scenario_file import load_scenario

        loaded = load_scenario(scenario, settings or ())
        from rich.console import Console

        from scenarios.run import run_scenario
        from scenarios.terminal import TerminalWatcher, show_result

        with TerminalWatcher(loaded, interruption, compiles) as watcher:
            result = run_scenario(loaded, out, watcher, command=["railslide", *sys.argv[1:]], figures=figures)
        show_result(Console(), loaded, result)


@app.command()
def check(
    file: Annotated[str, typer.Argument(help="Path to a .toml file, or the name of a built-in scenario.")],
    settings: Settings = None,
) -> None:
    """Validate a scenario without running it."""
    with _exit_codes():
        loaded = _load(file, settings)
        typer.echo(f"{file}: scenario {loaded.name} is valid")


@app.command()
def contact(
    scenario: ScenarioArgument,
    settings: Settings = None,
    out: Annotated[
        Path,
        typer.Option(help="Where the folder <scenario.name>.contact is made; an older one of that name is replaced."),
    ] = Path("runs"),
) -> None:
    """Show how the wheels of a scenario's coach touch its rails: figures, pictures, creep laws."""
    with _exit_codes() as interruption:
        loaded = _load(scenario, settings)
        from rich.console import Console

        from scenarios.contact_report import report_contact

        report_contact(Console(), loaded, out, interruption)


@app.command()
def inspect(
    coach: Annotated[str, typer.Argument(help="Name of a coach preset, or a path to a .toml file of the same form.")],
    settings: Annotated[
        list[str] | None, typer.Option("--set", metavar="KEY=VALUE", help="Override a key, as in body.mass_kg=42000.")
    ] = None,
    out: Annotated[
        Path, typer.Option(help="Where the folder <name>.coach is made; an older one of that name is replaced.")
    ] = Path("runs"),
    speed: Annotated[float, typer.Option(min=1.0, max=500.0, metavar="KMH", help="Speed of the swings, km/h.")] = 100.0,
) -> None:
    """Show a coach: masses, static loads, suspension, modes, hunting speed, with a drawing and pictures."""
    with _exit_codes() as interruption:
        use_compile_cache()
        from scenarios.coach_file import load_coach

        loaded = load_coach(coach, settings or ())
        from rich.console import Console

        from scenarios.inspect_report import report_coach
        from scenarios.units import KMH_PER_MPS

        report_coach(Console(), Path(coach).stem, loaded, speed / KMH_PER_MPS, out, interruption)


@app.command(name="export-fmu")
def export_fmu(
    scenario: ScenarioArgument,
    settings: Settings = None,
    out: Annotated[Path, typer.Option(help="The file to write; an older one is replaced.")] = Path("coach.fmu"),
    fmi: Annotated[int, typer.Option(min=2, max=3, help="Version of the FMI standard: 2 (2.0) or 3 (3.0).")] = 2,
) -> None:
    """Export the coach of a scenario as a co-simulation FMU: your tool works the valves (docs/coach-fmu.md)."""
    with _exit_codes():
        loaded = _load(scenario, settings)
        from scenarios.coach_fmu.export import export_fmu as export

        export(loaded, out, 2 if fmi == 2 else 3)
        typer.echo(f"{out}: the coach of {loaded.name}, FMI {fmi}.0, for 64-bit Linux and a Python with railslide")


@app.command()
def bench(
    rounds: Annotated[int, typer.Option(min=1, help="How often everything is measured, in turn.")] = 5,
    json_file: Annotated[
        Path | None, typer.Option("--json", metavar="FILE", help="Write medians and all values to this file.")
    ] = None,
) -> None:
    """Measure the speed of the solve on this machine, as medians and as ratios in one run."""
    with _exit_codes():
        use_compile_cache()
        from rich.console import Console

        from scenarios.bench import benchmark_table, run_benchmarks, write_benchmarks

        if json_file is not None:
            write_benchmarks(json_file, [])  # whether it can be written shows before the work
        with Console(stderr=True).status("measuring") as status:
            rows = run_benchmarks(rounds, lambda k: status.update(f"measuring, round {k + 1} of {rounds}"))
        Console().print(benchmark_table(rows))
        if json_file is not None:
            write_benchmarks(json_file, rows)


@app.command()
def verify(
    json_file: Annotated[
        Path | None, typer.Option("--json", metavar="FILE", help="Write the table to this file as well.")
    ] = None,
    docs: Annotated[
        Path | None,
        typer.Option(
            "--write-docs", metavar="DIR", help="Write the table to DIR/VALIDATION.md, with its pictures beside it."
        ),
    ] = None,
    without: Annotated[
        list[str] | None,
        typer.Option(metavar="AREA", help="Leave out an area, as in --without paths, the longest; may be repeated."),
    ] = None,
) -> None:
    """Check the program against published figures and closed forms; fails if one misses its tolerance."""
    with _exit_codes() as interruption:
        use_compile_cache()
        from rich.console import Console

        from scenarios.verification.command import verify_and_report

        if not verify_and_report(Console(), Console(stderr=True), json_file, docs, without or (), interruption):
            raise typer.Exit(FAILED)


@app.command(name="compare-models")
def compare_models(
    scenario: ScenarioArgument,
    settings: Settings = None,
    model: Annotated[
        str, typer.Option(help="The reduced model: point-mass, or point-mass-as-printed in the thesis.")
    ] = "point-mass",
) -> None:
    """Drive a scenario by the coach and by a point mass, and show how far they are apart."""
    with _exit_codes() as interruption:
        loaded = _load(scenario, settings)
        from rich.console import Console

        from scenarios.compare_models import compare_and_report

        compare_and_report(Console(), loaded, model, interruption)


@app.command(name="wsp-test")
def wsp_test(
    controller: Annotated[
        str, typer.Argument(help="Name of a controller, path/to/file.py:Name, a C library or an FMU.")
    ],
    settings: Annotated[
        list[str] | None,
        typer.Option(
            "--set",
            metavar="KEY=VALUE",
            help="Override a key in every stop, as in --set wsp.parameters.watchdog_s=7; may be repeated.",
        ),
    ] = None,
    only: Annotated[
        list[str] | None,
        typer.Option(
            "--only", metavar="NAME", help="A group or a stop, or a pattern as in 'low-05*'; may be repeated."
        ),
    ] = None,
    programme: Annotated[
        Path | None, typer.Option(metavar="FILE", help="A test programme of your own in place of the built-in one.")
    ] = None,
    limits: Annotated[
        Path | None, typer.Option(metavar="FILE", help="Limits of your own in place of the built-in ones.")
    ] = None,
    out: Annotated[
        Path,
        typer.Option(help="Where the folder wsp-test-<controller> is made; finished stops in it are not run again."),
    ] = Path("runs"),
    workers: Annotated[
        int | None, typer.Option(min=1, help="Processes that run stops; one for each core without it.")
    ] = None,
    figures: Annotated[
        str,
        typer.Option(
            metavar="none|summary|worst|all", help="Pictures: of the whole, of the worst stops besides, of all."
        ),
    ] = "worst",
    json_file: Annotated[
        Path | None, typer.Option("--json", metavar="FILE", help="Write the scorecard to this file as well.")
    ] = None,
    strict: Annotated[bool, typer.Option("--strict", help="Fail if a figure lies beyond its limit.")] = False,
) -> None:
    """Run a test programme for a wheel slide protection controller, EN 15595-style, and show its scorecard."""
    with _exit_codes() as interruption:
        use_compile_cache()
        from rich.console import Console

        from scenarios.wsp_test.command import Request, run_wsp_test
        from scenarios.wsp_test.limits import LIMITS
        from scenarios.wsp_test.programme import PROGRAMME

        request = Request(
            controller=controller,
            settings=tuple(settings or ()),
            programme=programme or PROGRAMME,
            limits=limits or LIMITS,
            only=tuple(only or ()),
            out=out,
            workers=workers or os.cpu_count() or 1,
            drawn=figures,
            json_file=json_file,
            command=("railslide", *sys.argv[1:]),
        )
        card = run_wsp_test(request, Console(), Console(stderr=True), interruption)
        if card.failures or (strict and card.count_beyond):
            raise typer.Exit(FAILED)


@app.command(name="list")
def list_names() -> None:
    """List scenarios, controllers, estimators and presets."""
    with _exit_codes():
        use_compile_cache()
        from rich.console import Console

        from scenarios.catalogue import catalogue_table

        Console().print(catalogue_table())


def _load(scenario: str, settings: list[str] | None) -> "Scenario":
    use_compile_cache()
    from scenarios.scenario_file import load_scenario

    return load_scenario(scenario, settings or ())


@contextmanager
def _exit_codes() -> Iterator[Interruption]:
    """Bad input, failed runs and Ctrl-C become one message and an exit code; errors of the program keep their trace."""
    with Interruption() as interruption:
        try:
            yield interruption
        except BadInput as error:
            _complain(error)
            raise typer.Exit(BAD_INPUT) from None
        except RunFailed as error:
            kept = f"; what it had is in {error.folder}" if error.folder else ""
            typer.echo(f"error: the run failed: {error}{kept}", err=True)
            raise typer.Exit(FAILED) from None
        except (KeyboardInterrupt, RunInterrupted) as error:
            typer.echo(str(error) or "interrupted, nothing was kept", err=True)
            raise typer.Exit(SIGNALLED + (interruption.number or 2)) from None


def _complain(error: BadInput) -> None:
    if len(error.faults) == 1:
        typer.echo(f"error: {error}", err=True)
        return
    typer.echo(f"error: {len(error.faults)} faults in the input", err=True)
    for fault in error.faults:
        typer.echo(f"  {fault}", err=True)
