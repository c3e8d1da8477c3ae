"""What others call the feedback: engines' own parameters, and a drive's gains, in alpha_hat and beta_hat.

    values in an engine's words -> what the engine makes of them -> (alpha_hat, beta_hat) and the method it steps with
    (alpha_hat, beta_hat) -> a line to paste

What an engine has no words for is refused, not guessed.
"""

from bezstab.engines.acceleration_engines import LEAST_IMPEDANCE, MOST_IMPEDANCE
from bezstab.engines.conversions import READ_BACK, Applied, Curve, EnergyClass, Engine, Level, Point
from bezstab.engines.drives import DRIVE_METHODS, FRESH, MOST_STEPS, Drive, Timing, timing_of
from bezstab.engines.engine_list import (
    ENGINE_ALIASES,
    ENGINES,
    RUN_UNDERNEATH,
    WITNESSES,
    engine_and_values,
    engine_named,
)
from bezstab.engines.sweeping import (
    MOST_SWEEPS,
    Move,
    Pass,
    SweptStep,
    VelocityOfMove,
    check_iterations,
    hard_velocity_step,
)
