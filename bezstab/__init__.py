"""Which Baumgarte parameters are safe, and best, for an integrator at its step size.

>>> import bezstab
>>> bezstab.verdict("SYM", alpha=500, beta=707.10678, h=0.002)
'diverges'

The names below are loaded when first used, so that `import bezstab` stays light. bezstab/README.md has examples.
"""

from bezstab.lazy import lazy_names

TYPE_CHECKING = False  # as type checkers know it; to import typing would take longer than all the rest

if TYPE_CHECKING:
    from bezstab.api import (
        best_point,
        check,
        choose,
        dominant_pole,
        feedback_cost,
        largest_step,
        method,
        poles,
        probe,
        probe_step,
        region,
        scene,
        simulate,
        spectral_radius,
        verdict,
        verify,
    )
    from bezstab.chains.answer import chain
    from bezstab.drives.answer import drive
    from bezstab.mujoco.linting import lint
    from bezstab.show import plot
    from bezstab.step_sequences.answer import steps
    from bezstab.units import from_dimensionless, to_dimensionless

__version__ = "0.2.0"

__getattr__ = lazy_names(__name__)

__all__ = [
    "best_point",
    "chain",
    "check",
    "choose",
    "dominant_pole",
    "drive",
    "feedback_cost",
    "from_dimensionless",
    "largest_step",
    "lint",
    "method",
    "plot",
    "poles",
    "probe",
    "probe_step",
    "region",
    "scene",
    "simulate",
    "spectral_radius",
    "steps",
    "to_dimensionless",
    "verdict",
    "verify",
]


def __dir__() -> list[str]:
    return sorted(__all__)
