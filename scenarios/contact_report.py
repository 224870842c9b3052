"""What `railslide contact` does: the figures of the contact as tables, a JSON file, and pictures in a folder."""

from collections.abc import Mapping
from pathlib import Path

from rich.console import Console
from rich.table import Table

from scenarios.contact_sheet import AMPLITUDES_MM, ContactSheet, contact_sheet, geometry_of
from scenarios.cosimulation.line import Line
from scenarios.errors import BadInput, Fault
from scenarios.interruption import Interruption
from scenarios.names import display_name
from scenarios.run_folder import PROGRAM, Contents, RunFolder
from scenarios.scenario_file import dump_scenario
from scenarios.schema import Scenario
from wheel_rail.creep_laws import CREEP_LAWS, LawInForce

CONTACT = Contents(
    frozenset({"scenario.toml", "contact.json", "contact-geometry.png", "creep-laws.png"}),
    "contact.json",
    "contact",
)


def report_contact(console: Console, scenario: Scenario, out: Path, interruption: Interruption) -> Path:
    """Show the tables and write the folder `out / <name>.contact`, whole or not at all; returns it.

    Raises BadInput for a folder that cannot be written or must not be replaced, and for profiles that end too soon.
    """
    with RunFolder(out, f"{scenario.name}.contact", CONTACT) as folder:
        line = Line(scenario)
        sheet = contact_sheet(scenario, line)
        (folder.path / "scenario.toml").write_text(dump_scenario(scenario), encoding="utf-8")
        folder.write_json(CONTACT.record, {"program": PROGRAM, **sheet.tree(scenario)})
        pictures = _draw(folder.path, scenario, line, sheet)
        with interruption.deferred():
            place = folder.publish()
    console.print(scenario.scenario.title or scenario.name, style="bold", markup=False, highlight=False)
    console.print(_contact_table(scenario, sheet))
    console.print(_conicity_table(sheet))
    console.print(_rail_table(sheet))
    for name in pictures:
        console.print(f"picture     {place / name}", highlight=False, soft_wrap=True)
    return place


def _draw(folder: Path, scenario: Scenario, line: Line, sheet: ContactSheet) -> list[str]:
    """The names of the pictures, drawn into `folder`."""
    from scenarios.figures.contact_geometry import draw_contact_geometry, draw_tabulated_geometry  # matplotlib is slow
    from scenarios.figures.creep_laws import draw_laws_on_rails
    from scenarios.figures.style import figure_style, write_png

    geometry = geometry_of(line)
    contact = line.contact
    with figure_style():
        if geometry is None:
            drawn = draw_tabulated_geometry(contact, _pair(scenario))
        else:
            reach_m = sheet.centred.flange_play_m + 2e-3
            try:
                drawn = draw_contact_geometry(geometry, contact.radius_m, _pair(scenario), reach_m)
            except ValueError as error:
                raise BadInput(Fault("", "coach.contact.profiles", str(error))) from None
        write_png(drawn, folder / "contact-geometry.png")
        write_png(draw_laws_on_rails(_laws(scenario), _law_name(scenario), contact, sheet), folder / "creep-laws.png")
    return ["contact-geometry.png", "creep-laws.png"]


def _law_name(scenario: Scenario) -> str:
    return display_name(scenario.creep_law.name)


def _laws(scenario: Scenario) -> Mapping[str, LawInForce]:
    """All laws with their own defaults, and the one in force as the scenario has it."""
    laws = {name: law.in_force() for name, law in CREEP_LAWS.items()}
    laws[_law_name(scenario)] = scenario.creep_law.in_force()
    return laws


def _pair(scenario: Scenario) -> str:
    """The wheel on the rail, in a line."""
    contact = scenario.coach.contact
    if contact.geometry == "profiles" and contact.profiles is not None:
        p = contact.profiles
        laid = f"at 1:{1.0 / p.rail_inclination:.0f}" if p.rail_inclination else "as measured"
        wheel, rail = (Path(name).name for name in (p.wheel_profile, p.rail_profile))
        return f"{wheel} on {rail} {laid}, gauge {1e3 * p.gauge_m:g} mm"
    cone = contact.conical
    if cone is None:
        return "conical"
    return f"cones of {cone.conicity:g} on a rail head of radius {1e3 * cone.rail_head_radius_m:g} mm"


def _contact_table(scenario: Scenario, sheet: ContactSheet) -> Table:
    c = sheet.centred
    parameters = scenario.coach.contact
    rows = [("wheel and rail", _pair(scenario))]
    if parameters.geometry == "profiles" and parameters.profiles is not None:
        rows.append(("back-to-back", f"{1e3 * parameters.profiles.back_to_back_m:g} mm"))
    rows += [
        ("wheel diameter", f"{2e3 * c.wheel_radius_m:g} mm"),
        ("play until the flange", f"±{1e3 * c.flange_play_m:.1f} mm"),
        ("load of a wheel", f"{1e-3 * c.load_n:.2f} kN"),
        ("contact ellipse, along x across", f"{2e3 * c.semi_axis_a_m:.2f} x {2e3 * c.semi_axis_b_m:.2f} mm"),
        ("peak pressure", f"{1e-6 * c.pressure_pa:.0f} MPa"),
        ("contact angle", f"{1e3 * c.angle_rad:.1f} mrad"),
        ("normal stiffness with the track's", f"{1e-6 * c.stiffness_npm:.1f} kN/mm"),
        ("Kalker's C11, C22, C23", f"{c.c11:.3f}, {c.c22:.3f}, {c.c23:.3f}"),
        ("creep law", _law_in_words(scenario)),
    ]
    table = Table(show_header=False)
    table.add_column()
    table.add_column(justify="right")
    for label, value in rows:
        table.add_row(label, value)
    return table


def _law_in_words(scenario: Scenario) -> str:
    parameters = scenario.creep_law.parameters.model_dump()
    own = ", ".join(f"{key} = {value}" for key, value in parameters.items())
    return f"{_law_name(scenario)} ({own})" if own else _law_name(scenario)


def _conicity_table(sheet: ContactSheet) -> Table:
    table = Table()
    table.add_column("amplitude  mm")
    for amplitude_mm in AMPLITUDES_MM:
        table.add_column(str(amplitude_mm), justify="right")
    values = ("-" if value is None else f"{value:.3f}" for value in sheet.centred.conicity)
    table.add_row("equivalent conicity", *values)
    return table


def _rail_table(sheet: ContactSheet) -> Table:
    """Peak adhesion at 68.7 kN and 100 km/h; the curves mu0 ((1 - A) exp(-B w) + A) with Polach's kA and kS."""
    table = Table()
    table.add_column("from m", no_wrap=True)
    table.add_column("surface", no_wrap=True)
    for name in ("peak\nadhesion", "mu0", "A", "B s/m", "kA", "kS"):
        table.add_column(name, justify="right", no_wrap=True)
    for sort in sheet.rails:
        low, high = f"{sort.peak_low:.3f}", f"{sort.peak_high:.3f}"
        peak = low if low == high else f"{low}..{high}"
        table.add_row(f"{sort.from_m:g}", sort.name, peak, *(f"{value:.3g}" for value in sort.degraded))
        if sort.recovered is not None:
            table.add_row("", "  recovered", "", *(f"{value:.3g}" for value in sort.recovered))
    return table
