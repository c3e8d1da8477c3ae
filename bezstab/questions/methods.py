"""The integrators that a question is about: those that were named, else the engine's own."""

from bezstab.engines.conversions import Engine
from bezstab.errors import InputError
from bezstab.methods.registry import lookup
from bezstab.methods.schemes import Method

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
