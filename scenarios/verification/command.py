"""What `railslide verify` does: progress, table, verdict, files."""

import os
from collections.abc import Collection
from pathlib import Path

from rich.console import Console

from scenarios.errors import BadInput, Fault
from scenarios.interruption import Interruption
from scenarios.verification import all_cases
from scenarios.verification.case import Case
from scenarios.verification.paths import PATH_GROUP, PUBLISHED, run_all
from scenarios.verification.report import (
    deviations,
    failures,
    missed,
    terminal_tables,
    verdict,
    verify,
    write_json,
    write_page,
)


def verify_and_report(
    console: Console,
    progress: Console,
    json_file: Path | None,
    docs: Path | None,
    without: Collection[str] = (),
    interruption: Interruption | None = None,
) -> bool:
    """Compute and show the table, the areas `without` excepted, write the files asked for; whether no row missed.

    The progress goes to `progress` where that is a terminal. Raises BadInput, before any work, for files that cannot
    be written and areas that there are not, RunInterrupted on Ctrl-C in the runs of the test paths.
    """
    try:
        cases = all_cases(without)
    except ValueError as error:
        raise BadInput(Fault("--without", "", str(error))) from None
    if json_file is not None:
        write_json(json_file, [])
    if docs is not None and not docs.is_dir():
        raise BadInput(Fault("--write-docs", str(docs), "is not a folder"))
    with progress.status("compiling") as status:

        def on_case(k: int, case: Case) -> None:
            status.update(f"{k + 1} of {len(cases)}: {case.group}")

        if any(case.group.startswith(PATH_GROUP) for case in cases):
            status.update("running the test paths")
            for done, number in enumerate(run_all(os.cpu_count() or 1, interruption or Interruption()), start=1):
                status.update(f"test path {number} done, {done} of {len(PUBLISHED)}")
        outcomes = verify(cases, on_case)
        if json_file is not None:
            write_json(json_file, outcomes)
        if docs is not None:
            from scenarios.verification.pictures import write_pictures  # matplotlib takes a while to import

            status.update("drawing")
            write_page(docs, outcomes, write_pictures(docs))
    for table in terminal_tables(outcomes):
        console.print(table)
    for line in deviations(outcomes):
        console.print(f"known deviation: {line}", highlight=False, markup=False)
    for line in failures(outcomes):
        console.print(f"failed: {line}", highlight=False, markup=False)
    console.print(verdict(outcomes), highlight=False)
    return not missed(outcomes)
