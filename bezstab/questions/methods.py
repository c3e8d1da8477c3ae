"""What a question leaves open: the integrators, else the engine's own, and the goal of a choice."""

from bezstab.engines.conversions import Engine
from bezstab.errors import InputError
from bezstab.goals import Goal
from bezstab.methods.registry import lookup
from bezstab.methods.schemes import Method
from bezstab.stability.feedback_costs import follows_motion

WHICH_METHOD = (
    "which integrator? --method SYM (semi-implicit Euler, as most engines have), RK4, rk45 (solve_ivp's), AB4, "
    "B4 or another of `bezstab methods`; or an --engine"
)


def methods_for(methods: tuple[Method, ...], engine: Engine | None) -> tuple[Method, ...]:
    """Return the methods that are asked about: those given, else the engine's own.

    InputError where there are none, and for another method than its own with an engine whose steps are of one alone.
    """
    own = engine.method if engine else None
    if not methods:
        methods = (lookup(own),) if own else ()
    if not methods:
        raise InputError(
            f"{engine.name} has no integrator of its own: name yours with --method" if engine else WHICH_METHOD
        )
    if engine and engine.level != "acceleration" and [method.name for method in methods] != [own]:
        raise InputError(
            f"{engine.name} works at {engine.level} level: its steps are those of {own}, only with --method {own}"
        )
    return methods


def usual_goal(engine: Engine | None, methods: tuple[Method, ...] = ()) -> Goal:
    """Return the goal for a question that names none: robust in an engine, else accurate.

    In an engine bodies collide, and the feedback that forces least lets what a collision leaves die slowly; but where
    that feedback follows the motion, strong feedback forces far too much. On an engine's curve alpha and beta depend on
    each other, so that no gentle feedback can be found there. InputError as `methods_for`.
    """
    if engine and engine.curve:
        return "robust"
    return "robust" if engine and not all(map(follows_motion, methods_for(methods, engine))) else "accurate"
