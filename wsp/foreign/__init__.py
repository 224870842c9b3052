"""Controllers that are not Python: a C shared library or an FMU, run in a process of their own.

A crash, a hang or a nonsensical answer of theirs ends the run with a message and nothing else. The two sides:

- here: `controller` (what the co-simulation sees), `process` (the other process and its time limits), `parameters`;
- there: `worker` (the loop), `c_library` (ctypes), `fmu` (fmpy).

`frames` and `signals` are what both know. `railslide_controller.h` is the interface of a C library.
This file imports nothing, because the process loads it on its way to `worker`.
"""
