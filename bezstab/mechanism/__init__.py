"""Planar mechanisms: scenes as data, their equations of motion, and runs with feedback.

    scene (TOML data) -> compiled_mechanism (equations of motion, sympy) -> initial_state -> simulate -> observe

Units are SI and rad.
"""
