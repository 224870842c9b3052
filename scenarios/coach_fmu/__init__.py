"""The coach as a co-simulation FMU (FMI 2.0 or 3.0), for controllers in other people's tools.

`variables` is the one table of what goes in and out. `export` packs the resolved scenario, the model description
(`model_description`) and a shared library (`native/`, compiled at export) into the .fmu file. In the tool, the library
starts a Python with railslide that runs `server`: the same co-simulation as in a run, whose controller is the tool.
`host` is such a tool, as small as can be.

The coach ticks every 10 ms and a communication step is a whole number of ticks. Inputs set before a step act from the
start of that step to its end; outputs after it are those of its end. A controller that reads outputs at t and whose
answer the tool sets at the next communication point, as co-simulation masters do, has the one tick of delay that
controllers have inside railslide.
"""
