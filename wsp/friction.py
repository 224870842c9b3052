"""Friction of pads on discs and of blocks on wheels, and the heat that it leaves there."""

from wsp.brake_record import KARWATZKI, SPEED_FACTOR, TEMPERATURE_FACTOR
from wsp.compiled import Record, compiled

STEFAN_BOLTZMANN_WPM2K4 = 5.670374e-8
_KELVIN = 273.15


@compiled
def curve_value(number: int, x: float, b: Record) -> float:
    """Value at x of one of the record's curves: linear between its points, constant beyond."""
    last = b.curve_points[number] - 1
    if x <= b.curve_x[number, 0] or last == 0:
        return b.curve_y[number, 0]
    for k in range(1, last + 1):
        right = b.curve_x[number, k]
        if x < right:
            left = b.curve_x[number, k - 1]
            low = b.curve_y[number, k - 1]
            return low + (b.curve_y[number, k] - low) * (x - left) / (right - left)
    return b.curve_y[number, last]


@compiled
def karwatzki_friction(speed_kmh: float, block_force_kn: float) -> float:
    """Friction of a cast iron block on the tread, from the wheel's speed and the force of one block.

    mu = 0.6 (16 F/g + 100)/(80 F/g + 100) (v + 100)/(5 v + 100), v in km/h, F in kN, g = 9.81 (F/g: tonnes-force).
    Karwatzki's formula, M: taken from the handbooks' tradition, the original has not been seen.
    """
    tonnes = block_force_kn / 9.81
    return 0.6 * (16.0 * tonnes + 100.0) / (80.0 * tonnes + 100.0) * (speed_kmh + 100.0) / (5.0 * speed_kmh + 100.0)


@compiled
def friction_coefficient(axle: int, wheel_rate_radps: float, b: Record) -> float:
    """Friction of the axle's pads or blocks, pressed on as they are and as warm, at a speed of rotation."""
    sliding_mps = abs(wheel_rate_radps) * b.radius_m
    warmth = curve_value(TEMPERATURE_FACTOR, b.disc_temperature_degc[axle], b)
    if b.friction_law == KARWATZKI:
        return karwatzki_friction(3.6 * sliding_mps, b.block_kn_per_bar * b.pad_bar[axle]) * warmth
    return b.friction * curve_value(SPEED_FACTOR, sliding_mps, b) * warmth


@compiled
def heat_disc(axle: int, power_w: float, speed_mps: float, b: Record) -> None:
    """Heat balance of the axle's discs or wheels over one step: HeatParameters' equation."""
    temperature = b.disc_temperature_degc[axle]
    excess = temperature - b.ambient_degc
    loss = (b.cooling_wpk + b.cooling_speed_wspkm * abs(speed_mps)) * excess
    if b.radiating_area_m2 > 0.0:
        hot, cold = (temperature + _KELVIN) ** 2, (b.ambient_degc + _KELVIN) ** 2
        loss += b.radiating_area_m2 * STEFAN_BOLTZMANN_WPM2K4 * (hot * hot - cold * cold)
    b.disc_temperature_degc[axle] = temperature + (power_w - loss) * b.step_per_capacity
