"""Every published or closed-form figure that the project is checked against.

One file per area, each with a tuple `CASES`; an area is added by its file and a place in `all_cases`.
"""

from scenarios.verification.case import Case, Outcome

__all__ = ["Case", "Outcome", "all_cases"]


def all_cases() -> tuple[Case, ...]:
    """The cases of all areas, in the order of the table."""
    from scenarios.verification import (
        adhesion,
        brake,
        coach,
        coaches,
        contact_mechanics,
        convergence,
        creep_laws,
        curving,
        profiles,
        stability,
        track,
        vehicle,
        wheelset,
    )

    areas = (
        contact_mechanics, creep_laws, adhesion, profiles, wheelset, track, coach, coaches, vehicle, stability, curving,
        convergence, brake,
    )  # fmt: skip
    return tuple(case for area in areas for case in area.CASES)
