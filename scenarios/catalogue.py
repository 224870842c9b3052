"""What `railslide list` shows: every name that a scenario file may use, with a line on each."""

import inspect
from typing import Any

from rich.table import Table

from scenarios.layers import read_toml
from scenarios.names import TABLES


def catalogue_table() -> Table:
    """One row for each name, kind by kind."""
    table = Table()
    table.add_column("kind", no_wrap=True)
    table.add_column("name", no_wrap=True)
    table.add_column("what it is")
    for kind, read_table in TABLES.items():
        for name, entry in read_table().items():
            table.add_row(kind, name, _line_on(kind, entry))
        table.add_section()
    return table


def _line_on(kind: str, entry: Any) -> str:
    """A scenario's title, a law's own line, the first line of a docstring or of a preset's comment."""
    if kind == "scenario":
        return str(read_toml(entry).get("scenario", {}).get("title", ""))
    if kind == "creep law":
        return str(entry.description)
    if callable(entry):  # a class, or the function that draws a profile
        return (inspect.getdoc(entry) or "").partition("\n")[0]
    first = entry.read_text(encoding="utf-8").partition("\n")[0]
    return str(first.removeprefix("#").strip()) if first.startswith("#") else ""
