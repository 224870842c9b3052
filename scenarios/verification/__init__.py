"""Every published or closed-form figure that the project is checked against.

One file per area, each with a tuple `CASES`; an area is added by its file and a place in `AREAS`.
"""

from collections.abc import Collection
from importlib import import_module

from scenarios.verification.case import Case, Outcome

__all__ = ["AREAS", "Case", "Outcome", "all_cases"]


AREAS = (
    "contact_mechanics", "creep_laws", "adhesion", "profiles", "wheelset", "track", "coach", "coaches", "vehicle",
    "stability", "curving", "convergence", "brake", "point_mass", "paths",
)  # fmt: skip
"""Names of the areas, in the order of the table."""


def all_cases(without: Collection[str] = ()) -> tuple[Case, ...]:
    """The cases of all areas but those left out. Raises ValueError for an area that there is not."""
    for area in without:
        if area not in AREAS:
            raise ValueError(f"{area!r}: must be one of {', '.join(AREAS)}")
    modules = [import_module(f"scenarios.verification.{area}") for area in AREAS if area not in without]
    return tuple(case for module in modules for case in module.CASES)
