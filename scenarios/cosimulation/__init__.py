"""One run of coach, brake, tachometers, wheel slide protection and driver: `simulation.simulate`.

`line` is the world a scenario describes, `loop` what happens from tick to tick, `core` its compiled part, `driver` and
`fault_entries` hold what a scenario file says of driver and faults.
"""
