"""Tables of benchmarks; the figures themselves depend on the machine and are checked by nobody's tests."""

import json
from pathlib import Path

import pytest
from rich.console import Console

from scenarios.bench import FASTSIM, LONG_PATH, Benchmark, benchmark_table, write_benchmarks
from scenarios.errors import BadInput

ROWS = [
    Benchmark(FASTSIM, "us", (30.0, 50.0, 20.0)),
    Benchmark(LONG_PATH, "times real time", (250.0,)),
    Benchmark("something else", "ratio", (2.0,)),
]


def test_required_values_stand_beside_the_medians(tmp_path: Path) -> None:
    console = Console(width=200, record=True, file=(tmp_path / "table").open("w"))
    console.print(benchmark_table(ROWS))
    console.file.close()
    lines = [line.split("│") for line in (tmp_path / "table").read_text().splitlines() if line.startswith("│")]
    cells = [[cell.strip() for cell in line[1:-1]] for line in lines]
    assert cells == [
        [FASTSIM, "us", "30", "<= 40", "20", "50"],
        [LONG_PATH, "times real time", "250", ">= 300", "250", "250"],
        ["something else", "ratio", "2", "", "2", "2"],
    ]
    write_benchmarks(tmp_path / "bench.json", ROWS)
    first, second, third = json.loads((tmp_path / "bench.json").read_text()).values()
    assert first == {"unit": "us", "median": 30.0, "at_most": 40.0, "at_least": None, "values": [30.0, 50.0, 20.0]}
    assert (second["at_most"], second["at_least"]) == (None, 300.0)
    assert (third["at_most"], third["at_least"]) == (None, None)


def test_a_file_that_cannot_be_written_is_refused(tmp_path: Path) -> None:
    with pytest.raises(BadInput, match="cannot be written"):
        write_benchmarks(tmp_path / "gone" / "bench.json", ROWS)
