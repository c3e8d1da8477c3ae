"""Which Baumgarte parameters are safe, and best, for an integrator at its step size.

>>> import bezstab
>>> bezstab.verdict("SYM", alpha=500, beta=707.10678, h=0.002)
'diverges'

Public names are loaded when first used, so that `import bezstab` stays light. bezstab/README.md has examples.
"""

TYPE_CHECKING = False  # as type checkers know it; to import typing would take longer than all the rest

if TYPE_CHECKING:
    from bezstab.api import best_point as best_point
    from bezstab.api import dominant_pole as dominant_pole
    from bezstab.api import feedback_cost as feedback_cost
    from bezstab.api import poles as poles
    from bezstab.api import spectral_radius as spectral_radius
    from bezstab.api import verdict as verdict
    from bezstab.chains.answer import chain as chain
    from bezstab.drives.answer import drive as drive
    from bezstab.feedback.checking import check as check
    from bezstab.feedback.checking import largest_step as largest_step
    from bezstab.feedback.choosing import choose as choose
    from bezstab.mechanism.scene_files import scene as scene
    from bezstab.methods.registry import method as method
    from bezstab.mujoco.linting import lint as lint
    from bezstab.probes.answer import probe as probe
    from bezstab.regions.answer import region as region
    from bezstab.runs.simulating import simulate as simulate
    from bezstab.runs.trades import tradeoff as tradeoff
    from bezstab.runs.verifying import verify as verify
    from bezstab.show import plot as plot
    from bezstab.step_sequences.answer import steps as steps
    from bezstab.units import from_dimensionless as from_dimensionless
    from bezstab.units import to_dimensionless as to_dimensionless

__version__ = "0.2.0"

HOMES = {
    **dict.fromkeys(
        (
            "best_point",
            "dominant_pole",
            "feedback_cost",
            "poles",
            "spectral_radius",
            "verdict",
        ),
        "bezstab.api",
    ),
    "chain": "bezstab.chains.answer",
    "largest_step": "bezstab.feedback.checking",
    "choose": "bezstab.feedback.choosing",
    "check": "bezstab.feedback.checking",
    "drive": "bezstab.drives.answer",
    "from_dimensionless": "bezstab.units",
    "lint": "bezstab.mujoco.linting",
    "method": "bezstab.methods.registry",
    "plot": "bezstab.show.plot",
    "probe": "bezstab.probes.answer",
    "region": "bezstab.regions.answer",
    "scene": "bezstab.mechanism.scene_files",
    "simulate": "bezstab.runs.simulating",
    "steps": "bezstab.step_sequences.answer",
    "to_dimensionless": "bezstab.units",
    "tradeoff": "bezstab.runs.trades",
    "verify": "bezstab.runs.verifying",
}
"""The module of each public name, which type checkers read above."""

__all__ = sorted(HOMES)  # noqa: PLE0605 - a list


def __getattr__(name: str) -> object:
    if name not in HOMES:
        raise AttributeError(f"module 'bezstab' has no attribute {name!r}")
    from importlib import import_module

    home = import_module(HOMES[name])
    return home if HOMES[name].endswith(f".{name}") else getattr(home, name)


def __dir__() -> list[str]:
    return __all__
