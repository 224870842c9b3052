"""Brake and wheel slide protection (WSP): speeds in, cylinder pressures and friction torques out. Knows no vehicle.

Conventions of the package:

- Axles 1..4 from the front, index 0..3; every array over axles has shape (4,).
- Bogies 0 and 1 carry axles 0, 1 and 2, 3.
- Pressures: bar gauge in every public name but those of `wsp.pneumatics`, which are bar absolute. Atmosphere 1.013 bar.
  Pad pressure: the force of the pads as a pressure, behind return spring and friction of the linkage (`wsp.cylinder`).
- Air: normal litres (`_nl`, 1.013 bar, 20 degC); conductances C in dm3/(s bar) and critical ratios b as ISO 6358 has
  them. Balances: drawn = kept in the cylinders + vented + leaked; supplied by the feed pipe = drawn + let off + kept in
  the reservoir.
- Torques in Nm, at the wheelset, never negative: friction and dynamic brake can only oppose the rotation. Of friction
  the capacity is given; whether a standing wheel uses it is resolved where the wheel is. The dynamic torque is what
  acts: it is zero where the wheel stands. Track brake: force in N per bogie, never negative, against the motion.
  Torques of traction (`wsp.anti_skid`) have the sign of the rotation that they drive.
- Temperature of discs, or of wheels under tread brakes, in degC, one per axle.
- Speeds in m/s at the rim, positive forward; `direction` of travel +1 or -1. Slip (v - rim)/v, positive when the rim
  is slower.
- Demand 0..1 of full service. Valve codes FILL, HOLD, VENT = 0, 1, 2 (`wsp.valves`).
- Time: `Brake.step` covers one step from t to t + step_s; a command handed to it acts from t + dead time on, to
  the sample; wheel and train speeds handed to it are those of t. A controller works at its own period, a whole
  multiple of 10 ms, and adds no delay to its link: the answer to what it read at one tick is applied by the
  co-simulation from the next tick on.
- No randomness here.

Brakes come by `BRAKE_PRESETS` (name -> TOML file of `BrakeParameters`), controllers by `CONTROLLERS` (name -> class
with its `Parameters`); traction has `wsp.anti_skid.AntiSkid`. Figures marked M are known at second hand.
"""

from wsp.anti_skid import AntiSkid
from wsp.anti_skid_parameters import AntiSkidParameters
from wsp.brake import Brake
from wsp.controllers import CONTROLLERS, Controller, ControllerOutput
from wsp.parameters import BRAKE_PRESETS, BrakeParameters
from wsp.valves import FILL, HOLD, VENT

__all__ = [
    "BRAKE_PRESETS",
    "CONTROLLERS",
    "FILL",
    "HOLD",
    "VENT",
    "AntiSkid",
    "AntiSkidParameters",
    "Brake",
    "BrakeParameters",
    "Controller",
    "ControllerOutput",
]
