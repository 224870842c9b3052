"""What `railslide inspect` does: a coach in tables, a JSON file, and pictures in a folder."""

from pathlib import Path

from rich.console import Console
from rich.table import Table

from scenarios.coach_sheet import CURVE_CANT_MM, CURVE_RADIUS_M, CoachSheet, coach_sheet
from scenarios.errors import BadInput, Fault
from scenarios.interruption import Interruption
from scenarios.run_folder import PROGRAM, Contents, RunFolder
from scenarios.units import KMH_PER_MPS
from vehicle import CoachParameters

PICTURES = ("drawing.png", "mode-shapes.png", "characteristics.png", "root-locus.png", "wheel-loads.png")
INSPECTION = Contents(frozenset({"inspect.json", *PICTURES}), "inspect.json", "coach")


def report_coach(
    console: Console, name: str, coach: CoachParameters, speed_mps: float, out: Path, interruption: Interruption
) -> Path:
    """Show the tables and write the folder `out / <name>.coach`, whole or not at all; returns it.

    Raises BadInput for a folder that cannot be written or must not be replaced, and for a coach that cannot stand.
    """
    with RunFolder(out, f"{name}.coach", INSPECTION) as folder:
        try:
            sheet = coach_sheet(name, coach, speed_mps)
        except ValueError as error:
            raise BadInput(Fault(name, "", str(error))) from None
        folder.write_json(INSPECTION.record, {"program": PROGRAM, **sheet.tree()})
        _draw(folder.path, sheet)
        with interruption.deferred():
            place = folder.publish()
    console.print(name, style="bold", markup=False, highlight=False)
    for table in (
        _mass_table(sheet),
        _load_table(sheet),
        _spring_table(sheet),
        _characteristic_table(sheet),
        _mode_table(sheet),
        _hunting_table(sheet),
        _curve_table(sheet),
    ):
        console.print(table)
    for picture in PICTURES:
        console.print(f"picture     {place / picture}", highlight=False, soft_wrap=True)
    return place


def _draw(folder: Path, sheet: CoachSheet) -> None:
    from scenarios.figures.coach_drawing import draw_coach  # matplotlib takes a while to import
    from scenarios.figures.coach_loads import draw_characteristics, draw_wheel_loads
    from scenarios.figures.mode_shapes import draw_mode_shapes, draw_root_locus
    from scenarios.figures.style import figure_style, write_png

    drawers = (draw_coach, draw_mode_shapes, draw_characteristics, draw_root_locus, draw_wheel_loads)
    with figure_style():
        for name, draw in zip(PICTURES, drawers, strict=True):
            write_png(draw(sheet), folder / name)


def _table(title: str, first: str, *others: str) -> Table:
    table = Table(title=title, title_justify="left", title_style="bold")
    table.add_column(first, no_wrap=True)
    for heading in others:
        table.add_column(heading, justify="right", no_wrap=True)
    return table


def _number(value: float | None, form: str = ".4g", scale: float = 1.0) -> str:
    return "-" if value is None else format(scale * value, form)


def _mass_table(sheet: CoachSheet) -> Table:
    total = sheet.parameters.mass_kg / 1e3
    table = _table(
        f"masses, {total:.2f} t in all", "body", "number", "mass\nkg", "roll\nkg m²", "pitch", "yaw", "at\nm"
    )
    for body in sheet.bodies:
        inertias = (body.roll_inertia_kgm2, body.pitch_inertia_kgm2, body.yaw_inertia_kgm2)
        table.add_row(
            body.name, str(body.count), f"{body.mass_kg:,.0f}", *(f"{i:,.0f}" for i in inertias), f"{body.height_m:.3f}"
        )
    return table


def _load_table(sheet: CoachSheet) -> Table:
    loads = sheet.loads
    table = _table("static loads on level track", "", *(str(k) for k in range(1, 5)))
    for side, name in ((0, "left wheel  kN"), (1, "right wheel  kN")):
        table.add_row(name, *(f"{load / 1e3:.2f}" for load in loads.wheel_load_n[side::2]))
    table.add_section()
    for name, count in (("primary", 8), ("secondary", 4)):
        rows = slice(0, 8) if name == "primary" else slice(-count, None)
        force, sag = loads.spring_load_n[rows].mean(), loads.spring_deflection_m[rows].mean()
        table.add_row(f"{name} spring, mean", f"{force / 1e3:.1f} kN", f"{1e3 * sag:.1f} mm", "", "")
    return table


def _spring_table(sheet: CoachSheet) -> Table:
    table = _table("suspension, linear part of each", "element", "number", "unit", "x", "y", "z")
    for spring in sheet.springs:
        rows = (
            ("kN/m", spring.stiffness_npm),
            ("kNs/m", spring.damping_nspm),
            ("kNm/rad", spring.rotational_stiffness_nmprad),
        )
        name, count = spring.name, str(spring.count)
        for unit, values in rows:
            if any(values):
                table.add_row(name, count, unit, *(_number(value or None, ",.5g", 1e-3) for value in values))
                name = count = ""
    return table


def _characteristic_table(sheet: CoachSheet) -> Table:
    table = _table("characteristics", "name", "first slope", "last point", "source")
    table.columns[-1].no_wrap, table.columns[-1].justify = False, "left"  # sentences
    for key, curve in sheet.parameters.characteristics.items():
        speed = curve.speed_mps is not None
        (x, force), _ = curve.halves()
        slope = force[1] / x[1]
        first = f"{slope / 1e3:,.4g} {'kNs/m' if speed else 'kN/m'}" if slope else f"free to {1e3 * x[1]:g} mm"
        last = f"{force[-1] / 1e3:g} kN at " + (f"{x[-1]:g} m/s" if speed else f"{1e3 * x[-1]:g} mm")
        table.add_row(key, first, last, curve.source)
    return table


def _mode_table(sheet: CoachSheet) -> Table:
    kmh = KMH_PER_MPS * sheet.speed_mps
    table = _table(
        f"swings at {kmh:.0f} km/h, dampers and creep as for small ones", "mode", "frequency\nHz", "damping\n%"
    )
    for mode in sheet.modes:
        table.add_row(mode.name, f"{mode.frequency_hz:.2f}", f"{100.0 * mode.damping_ratio:.1f}")
    return table


def _hunting_table(sheet: CoachSheet) -> Table:
    table = _table("hunting, critical speed by linear theory", "wheels", "conicity", "speed\nkm/h", "swing\nHz")
    for on, found in sheet.hunting:
        speed = "stable" if found.speed_mps is None else f"{KMH_PER_MPS * found.speed_mps:.0f}"
        table.add_row(on, f"{found.conicity:.3f}", speed, _number(found.frequency_hz, ".2f"))
    return table


def _curve_table(sheet: CoachSheet) -> Table:
    title = f"steady in a left-hand curve of {CURVE_RADIUS_M:g} m, cant {CURVE_CANT_MM:g} mm"
    table = _table(title, "deficiency", "speed\nkm/h", "left rail\nkN", "right rail\nkN", "roll\nmrad", "flexibility")
    for curve in sheet.curves:
        loads = curve.loads
        table.add_row(
            f"{curve.deficiency_mm:g} mm",
            f"{KMH_PER_MPS * loads.speed_mps:.1f}",
            f"{loads.wheel_load_n[0::2].sum() / 1e3:.1f}",
            f"{loads.wheel_load_n[1::2].sum() / 1e3:.1f}",
            f"{1e3 * loads.body_roll_rad:.1f}",
            _number(curve.flexibility, ".3f"),
        )
    return table
