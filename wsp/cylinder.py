"""The cylinders of one axle: stroke, return spring, friction of the linkage, and the air that all of it takes.

The gauge pressure p moves the pistons against the return spring from p0 (`preload`) until the pads touch at p1
(`lay on`), then it presses them on with the pad pressure q. Friction in the linkage is a play whose width grows with
the force: q stays where it is while

    max(0, p - p1) <= q <= (1 + h) max(0, p - p1)

allows, and is carried along by the bound that it meets: the lower one as p rises, the upper one as p falls. The volume
grows by the clearance stroke and with the force, so that in the plane of pressure and volume the friction takes work
from every cycle:

    V(p, q) = V0 + Vc clip((p - p0)/(p1 - p0), 0, 1) + k q

The air held is (p + 1.013 bar) V; all balances are made with it. A step of flow uses wsp.pneumatics' exact solutions
with the secant of the air held over pressure as volume, which is exact where V is constant and of second order else.
"""

from wsp.compiled import Record, compiled
from wsp.pneumatics import ATMOSPHERE_BAR, flow_factor, pressure_emptied_bar, pressure_filled_bar

_RESOLVED = 1e-7
"""Share of the pressure below which a secant is only rounding noise."""
_SLIGHT = 1e-6
"""Exchange, as by leakage, that one explicit step does as well."""


@compiled
def pad_pressure_bar(pressure_bar: float, before_bar: float, b: Record) -> float:
    """Pad pressure q at a cylinder pressure (gauge), having been before_bar: the play of the linkage."""
    rising = max(0.0, pressure_bar - b.lay_on_bar)
    return min(max(before_bar, rising), b.falling_factor * rising)


@compiled
def cylinder_volume_dm3(pressure_bar: float, pad_bar: float, b: Record) -> float:
    """Volume behind the valves of an axle, dm3."""
    volume = b.volume_dm3 + b.elastic_dm3pbar * pad_bar
    if b.clearance_dm3 > 0.0 and pressure_bar > b.preload_bar:
        volume += b.clearance_dm3 * min(1.0, (pressure_bar - b.preload_bar) / (b.lay_on_bar - b.preload_bar))
    return volume


@compiled
def _growth_dm3pbar(pressure_bar: float, pad_bar: float, rises: bool, b: Record) -> float:
    """dV/dp on the way up or down."""
    if pressure_bar > b.lay_on_bar or (rises and pressure_bar == b.lay_on_bar):
        rising = pressure_bar - b.lay_on_bar
        if rises:
            return b.elastic_dm3pbar if pad_bar <= rising else 0.0
        return b.elastic_dm3pbar * b.falling_factor if pad_bar >= b.falling_factor * rising else 0.0
    if b.clearance_dm3 > 0.0 and (pressure_bar > b.preload_bar or (rises and pressure_bar == b.preload_bar)):
        return b.clearance_dm3 / (b.lay_on_bar - b.preload_bar)
    return 0.0


@compiled
def _capacity_dm3(axle: int, other_bar: float, passage_dm3pbar: float, held: float, volume: float, b: Record) -> float:
    """Secant of the air held over the pressure that the step will about change, towards other_bar (absolute)."""
    pressure = b.cylinder_bar[axle]
    before = pressure + ATMOSPHERE_BAR
    rises = other_bar > before
    capacity = volume + before * _growth_dm3pbar(pressure, b.pad_bar[axle], rises, b)
    if rises:
        rise = passage_dm3pbar / capacity * other_bar * flow_factor(before / other_bar, b.critical_ratio)
        reached = min(other_bar, before + rise)
    else:
        fall = passage_dm3pbar / capacity * before * flow_factor(other_bar / before, b.critical_ratio)
        reached = max(other_bar, before - fall)
    change = reached - before
    if abs(change) <= _RESOLVED * before:
        return capacity
    pad = pad_pressure_bar(reached - ATMOSPHERE_BAR, b.pad_bar[axle], b)
    return (reached * cylinder_volume_dm3(reached - ATMOSPHERE_BAR, pad, b) - held) / change


@compiled
def exchange_air(axle: int, other_bar: float, passage_dm3pbar: float, b: Record) -> float:
    """Let the axle's cylinders exchange air with a place of constant gauge pressure; return what came in, bar dm3.

    passage_dm3pbar is conductance times time (temperature included). Sets cylinder and pad pressure. What comes in is
    never negative if the other pressure is above the cylinders', never positive if below: all that follows from the
    pressure reached is monotone in it, rounding included.
    """
    pressure = b.cylinder_bar[axle]
    if pressure == other_bar:
        return 0.0
    pad = b.pad_bar[axle]
    volume = cylinder_volume_dm3(pressure, pad, b)
    before, other = pressure + ATMOSPHERE_BAR, other_bar + ATMOSPHERE_BAR
    held = before * volume
    exchange = passage_dm3pbar
    if b.elastic_dm3pbar > 0.0 or b.clearance_dm3 > 0.0:
        exchange /= _capacity_dm3(axle, other, passage_dm3pbar, held, volume, b)
    else:
        exchange /= volume
    if exchange <= _SLIGHT:
        upper, lower = max(before, other), min(before, other)
        flow = exchange * upper * flow_factor(lower / upper, b.critical_ratio)
        after = min(other, before + flow) if other > before else max(other, before - flow)
        arrived = after == other
    elif other > before:
        after = pressure_filled_bar(before, other, exchange, b.critical_ratio)
        arrived = after >= other
    else:
        after = pressure_emptied_bar(before, other, exchange, b.critical_ratio)
        arrived = after <= other
    # to the last bit: cylinders in balance stay so, and rounding moves no air against the difference of pressure
    if arrived:
        reached = other_bar
    elif other_bar > pressure:
        reached = max(pressure, after - ATMOSPHERE_BAR)
    else:
        reached = min(pressure, max(0.0, after - ATMOSPHERE_BAR))
    pad = pad_pressure_bar(reached, pad, b)
    b.cylinder_bar[axle] = reached
    b.pad_bar[axle] = pad
    return (reached + ATMOSPHERE_BAR) * cylinder_volume_dm3(reached, pad, b) - held
