"""Scenario files, co-simulation, run folders, metrics, figures and the command line; the one package that knows all.

This file imports nothing, so that the command line starts fast; the way in for a program is

    from scenarios.run import run_scenario
    from scenarios.scenario_file import load_scenario
"""
