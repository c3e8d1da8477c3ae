"""What others call the feedback: engines' own parameters, and a drive's gains, in alpha_hat and beta_hat.

    values in an engine's words -> what the engine makes of them -> (alpha_hat, beta_hat) and the method it steps with
    (alpha_hat, beta_hat) -> a line to paste

From data upwards; a file imports only from those above it:

    sweeping             how an engine that sweeps goes through a step
    conversions          what an engine is: its words read and written, its clamps, its own integrator
    acceleration_engines true Baumgarte feedback: the integrator decides
    velocity_engines     impulse engines, whose velocity update feeds part of the error back
    position_engines     engines that move positions and derive velocities from that
    implicit_engines     springs and drives that are solved implicitly
    drives               a joint's proportional and derivative gains
    engine_list          all engines by name, and which of them a run has witnessed
"""

from bezstab.engines.conversions import Applied, Curve, Engine, Point
from bezstab.engines.drives import DRIVE_METHODS, Drive
from bezstab.engines.engine_list import ENGINES, RUN_UNDERNEATH, WITNESSES, engine_and_values, engine_named, witness_of
from bezstab.engines.sweeping import (
    MOST_SWEEPS,
    Move,
    Pass,
    SweptStep,
    VelocityOfMove,
    check_iterations,
    hard_velocity_step,
)

__all__ = [
    "DRIVE_METHODS",
    "ENGINES",
    "MOST_SWEEPS",
    "RUN_UNDERNEATH",
    "WITNESSES",
    "Applied",
    "Curve",
    "Drive",
    "Engine",
    "Move",
    "Pass",
    "Point",
    "SweptStep",
    "VelocityOfMove",
    "check_iterations",
    "engine_and_values",
    "engine_named",
    "hard_velocity_step",
    "witness_of",
]
