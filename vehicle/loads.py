"""Loads of a coach: what passengers and luggage add to the body."""

from pydantic import BaseModel, ConfigDict, Field

EMPTY = "empty"
"""The load that every coach has without naming it."""

Inertias = tuple[float, float, float]


class Saloon(BaseModel):
    """The room for the payload: a box that stands on the floor, in the middle of the body."""

    model_config = ConfigDict(extra="forbid", frozen=True, allow_inf_nan=False)

    length_m: float = Field(gt=0.0, le=100.0)
    width_m: float = Field(gt=0.0, le=10.0)
    floor_height_m: float = Field(gt=0.0, le=5.0, description="above the rail")
    roof_height_m: float = Field(gt=0.0, le=10.0, description="inside, above the rail")


class Payload(BaseModel):
    """Payload of one load, its centre of mass above the body's and `height_m` above the rail."""

    model_config = ConfigDict(extra="forbid", frozen=True, allow_inf_nan=False)

    mass_kg: float = Field(gt=0.0, le=200_000.0)
    height_m: float = Field(gt=0.0, le=10.0, description="of its centre of mass, above the rail")
    inertia_kgm2: tuple[float, float, float] | None = Field(
        default=None,
        description="roll, pitch, yaw about its own centre; without it those of a uniform box as long and wide as the "
        "saloon, from the floor to as far above the centre as the floor is below it",
    )

    def fault(self, saloon: Saloon | None) -> str | None:
        """What keeps this payload from having its place in the saloon, as `key = value: reason`; None if nothing."""
        if self.inertia_kgm2 is not None and not all(i > 0.0 for i in self.inertia_kgm2):
            return f"inertia_kgm2 = {list(self.inertia_kgm2)}: must be greater than 0"
        if saloon is None:
            return None if self.inertia_kgm2 else "inertia_kgm2: is missing, and without saloon it cannot be worked out"
        if self.height_m <= saloon.floor_height_m:
            return f"height_m = {self.height_m}: lies below saloon.floor_height_m = {saloon.floor_height_m}"
        top_m = self.height_m if self.inertia_kgm2 else 2.0 * self.height_m - saloon.floor_height_m
        if top_m > saloon.roof_height_m:
            return (
                f"height_m = {self.height_m}: the payload would reach {top_m:.2f} m, "
                f"above saloon.roof_height_m = {saloon.roof_height_m}"
            )
        return None

    def own_inertia_kgm2(self, saloon: Saloon | None) -> Inertias:
        """Roll, pitch and yaw inertia about the payload's own centre."""
        if self.inertia_kgm2 is not None or saloon is None:
            return self.inertia_kgm2 or (0.0, 0.0, 0.0)
        x, y, z = saloon.length_m, saloon.width_m, 2.0 * (self.height_m - saloon.floor_height_m)
        m = self.mass_kg / 12.0
        return m * (y * y + z * z), m * (x * x + z * z), m * (x * x + y * y)
