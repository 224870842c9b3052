"""The pictures of the validation page: the contact and the creep laws of its cases."""

from pathlib import Path

from matplotlib.backends.backend_agg import FigureCanvasAgg

from scenarios.errors import BadInput, Fault
from scenarios.figures.contact_geometry import draw_contact_geometry
from scenarios.figures.creep_laws import CreepSheet, draw_creep_laws
from scenarios.figures.style import figure_style
from scenarios.verification.contact_mechanics import (
    CONTACT_CURVE_N,
    LOAD_N,
    SHEAR_PA,
    SPEED_MPS,
    tractcurv_patch,
)
from scenarios.verification.creep_laws import CONSTANT_FRICTION, FALLING_CURVE_N, FALLING_FRICTION, FASTSIM_CURVE_N
from scenarios.verification.profiles import A22_CONTACTS, TRAILING, WHEEL_RADIUS_M, geometry
from wheel_rail.creep_laws import CREEP_LAWS


def write_pictures(folder: Path) -> list[tuple[str, str]]:
    """Draw into `folder`; returns (file name, caption) of each. Raises BadInput if they cannot be written."""
    slope, gauge_mm = 40, 1435.0
    # the trailing wheel is the left one of a wheelset displaced to the other side
    places = [(-y if wheel == TRAILING else y, place) for y, wheel, place, *_ in A22_CONTACTS]
    sheet = CreepSheet(
        LOAD_N,
        tractcurv_patch(),
        SHEAR_PA,
        SPEED_MPS,
        CONSTANT_FRICTION,
        FALLING_FRICTION,
        {"CONTACT": CONTACT_CURVE_N, "FASTSIM of CONTACT": FASTSIM_CURVE_N},
        {"modified FASTSIM of CONTACT": FALLING_CURVE_N},
    )
    name = f"S1002 on UIC60 at 1:{slope}, gauge {gauge_mm:.0f} mm"
    with figure_style():
        pair = geometry("s1002", "uic60", 1 / slope, gauge_mm / 1e3)
        contact = draw_contact_geometry(pair, WHEEL_RADIUS_M, name, 0.01, places)
        creep = draw_creep_laws({law: entry.in_force() for law, entry in CREEP_LAWS.items()}, sheet)
        drawn = [
            ("validation-contact-geometry.png", f"Contact geometry of {name}", contact),
            ("validation-creep-laws.png", "Creep laws on the ellipse of the case tractcurv", creep),
        ]
        for file, _, figure in drawn:
            try:
                FigureCanvasAgg(figure).print_png(folder / file, pil_kwargs={"compress_level": 9})
            except OSError as error:
                raise BadInput(Fault(str(folder / file), "", f"cannot be written: {error.strerror}")) from None
    return [(file, caption) for file, caption, _ in drawn]
