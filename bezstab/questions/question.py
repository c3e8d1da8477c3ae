"""A question about feedback: is a point safe, or which point does a goal give? It is checked when it is made.

Messages name options as the command line has them (--h-max); `bezstab.api` turns them into keywords (h_max).
"""

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property

from bezstab.engines.conversions import Applied, Engine, Point
from bezstab.errors import InputError
from bezstab.goals import SETTLING, UP_TO_LONGEST, Goal
from bezstab.mechanism.constraint_normals import TurningNormals
from bezstab.mechanism.equations import Mechanism, compiled_mechanism
from bezstab.mechanism.scenes import Scene
from bezstab.methods.registry import lookup
from bezstab.methods.schemes import Method
from bezstab.questions.chains import USUAL_CHAIN, SweptConstraints, constraints_of, constraints_of_chain
from bezstab.questions.motions import (
    ReferenceMotion,
    check_speed,
    motion_of,
    scene_at_speed,
    turn_too_far,
    turning_of,
)
from bezstab.stability.choices import choose, describe_point
from bezstab.stability.closed_loop import verdict
from bezstab.stability.feedback_costs import follows_motion
from bezstab.stability.forced_errors import OMEGA_H
from bezstab.units import check_step, from_dimensionless, to_dimensionless
from bezstab.words import SLOWLY

LARGE = 10
"""Above this alpha_hat or beta_hat 1/s was probably meant: as alpha_hat it leaves e^-5 of an error after a step."""

WHICH_METHOD = (
    "which integrator? --method SYM (semi-implicit Euler, as most engines have), RK4, rk45 (solve_ivp's), AB4, "
    "B4 or another of `bezstab methods`; or an --engine"
)


@dataclass(frozen=True, kw_only=True)
class Question:
    """A question about feedback: is a point safe (no `goal`), or which point does a `goal` give?

    The point is `point` (alpha_hat, beta_hat), or an `engine` gives it for its `values`. Without `methods` the
    engine's own method is asked about. `h` is the step (s). With
    `h_max` (s) a choice is for all steps up to it.
    The motion has a rate `omega` (1/s) or `omega_h` (rad a step), or is that of a `scene`, `speed` times as fast as
    given there. Safe then means: safe while the scene moves. Where the most accurate feedback follows the motion,
    `omega` is enough, and h is what makes OMEGA_H of it. `spread` is the share by which alpha and beta may be off.
    `settle` (s) is the time in which errors fall to a thousandth. `equal` keeps alpha = beta. `as_typed` leaves out an
    engine's clamps. With a `chain` of so many bodies, the last `mass_ratio` times as heavy as each other one (None: 1),
    or a scene of several constraints, safe also means: stable while the engine sweeps over them, `iterations` times in
    a step (None: the engine's own number). Without both, a choice for an engine that sweeps is for USUAL_CHAIN equal
    bodies.
    InputError for arguments that do not go together.
    """

    methods: tuple[Method, ...] = ()
    point: Point | None = None
    goal: Goal | None = None
    h: Fraction | None = None
    h_max: Fraction | None = None
    engine: Engine | None = None
    values: tuple[Fraction, ...] | None = None
    as_typed: bool = False
    omega: Fraction | None = None
    omega_h: Fraction | None = None
    scene: str | Scene | None = None
    speed: Fraction = Fraction(1)
    duration: Fraction | None = None
    spread: float = 0.1
    settle: Fraction | None = None
    equal: bool = False
    chain: int | None = None

    def __post_init__(self) -> None:
        for name in ("h", "h_max"):
            if (step := getattr(self, name)) is not None:
                check_step(step, name)
        if not self.goal:
            self._check_given()
        else:
            self._check_goal(self.goal)
            object.__setattr__(self, "chain", self.chain_to_choose_for)
            if self.h is None and self.omega and all(map(follows_motion, self.methods)):
                object.__setattr__(self, "h", OMEGA_H / self.omega)
        check_speed(self.scene, self.speed)
        self._check_duration()
        object.__setattr__(self, "methods", methods_for(self.methods, self.engine))
        if self.goal == "accurate" and self.settle is None:
            self.check_motion()

    def _check_duration(self) -> None:
        """Raise InputError for a time without a scene to run, or less than a step."""
        if self.duration is None:
            return
        if self.scene is None:
            raise InputError("--time needs --scene: it is how long that is run")
        if self.h and self.duration < self.h:
            raise InputError(f"--time {float(self.duration):g} s: expected at least one step of {float(self.h):g} s")

    def _check_given(self) -> None:
        """Raise InputError unless a point is given in one way, with the step that this way needs."""
        in_other_words = self.values is not None
        if self.h_max is not None:
            raise InputError("--h-max works only with --goal")
        if in_other_words and self.h is None:
            raise InputError("--physical and --engine need --h: the step in s")
        if self.as_typed and self.values is None:
            raise InputError("--as-typed needs --engine: it leaves out what that engine does to its values")
        if in_other_words and self.point is not None:
            raise InputError("--engine takes the place of --alpha, --beta and --physical")
        if not in_other_words and self.point is None:
            raise InputError("a point is needed: --alpha with --beta, or --engine")

    def _check_goal(self, goal: Goal) -> None:
        """Raise InputError for arguments that do not go with the goal."""
        if self.settle is None:
            if goal == "gentle":
                raise InputError("--goal gentle needs --settle: the time in s in which c falls a thousandfold")
        elif goal not in SETTLING:
            raise InputError(f"--settle works only with --goal gentle or accurate, not {goal}")
        elif self.settle <= 0:
            raise InputError(f"--settle {float(self.settle):g} s: expected a positive time")
        in_seconds = (self.h_max, self.settle, self.engine)
        if self.h is None:
            if any(each is not None for each in in_seconds):
                raise InputError("--h-max, --settle and --engine need --h: the step in s")
            return
        if self.h_max is not None and (goal not in UP_TO_LONGEST or self.h_max < self.h):
            raise InputError(
                f"--h-max {float(self.h_max):g}: only for --goal accurate or robust, and at least --h {float(self.h):g}"
            )
        if self.engine and self.engine.level != "acceleration" and self.h_max:
            raise InputError(
                f"choose cannot combine {self.engine.name} with --h-max; run "
                f"`bezstab check --engine {self.engine.name}=... --h STEP`"
            )

    def check_motion(self) -> None:
        """Raise InputError if the most accurate feedback of a method follows a motion whose rate is not known."""
        if not self.motion.assumed:
            return
        for method in filter(follows_motion, self.methods):
            chosen = choose(method, "accurate", spread=self.spread, equal=self.equal, margins=False)
            alpha, beta = from_dimensionless(chosen.alpha_hat, chosen.beta_hat, float(OMEGA_H))
            raise InputError(
                f"{method.name}: α = {alpha:.2g} ω, β = {beta:.2g} ω, ω the rate of your motion in rad/s: give --omega "
                "or --scene; --goal robust needs neither"
            )

    @cached_property
    def given(self) -> Applied:
        """The point that is asked about, and those at which the same values must be safe, too."""
        if self.values is not None and self.engine and self.h is not None:
            return self.engine.applied(self.values, self.h, as_typed=self.as_typed)
        assert self.point
        return Applied(self.point, None)

    @cached_property
    def motion(self) -> ReferenceMotion:
        """The motion on which errors are told; errors as `motion_of`."""
        try:
            return motion_of(self.omega, self.scene, self.speed, self.h, self.h_max, omega_h=self.omega_h)
        except InputError:
            at_rest = self.swept is not None and self.turning is not None and self.turning.kappa == 0
            if self.omega is not None or not at_rest:
                raise
            return motion_of(None, None, Fraction(1), self.h, self.h_max)  # the sweeps are what is asked about

    @property
    def chain_to_choose_for(self) -> int | None:
        """The bodies of the chain that a choice allows for, also where none is asked about and the engine sweeps."""
        if self.engine and self.engine.sweeping and self.chain is None and self.scene is None:
            return USUAL_CHAIN
        return self.chain

    @cached_property
    def swept(self) -> SweptConstraints | None:
        """The constraints that the engine sweeps over; None for one alone, and if it is not known how it sweeps."""
        if self.engine is None or self.engine.sweeping is None or self.h is None:
            return None
        if self.chain is not None:
            found = constraints_of_chain(self.chain)
        elif self.scene is None or len((found := constraints_of(self.scene, self.speed)).joints) == 1:
            return None
        return SweptConstraints(self.engine, self.h, found, self.engine.sweeping.iterations)

    @property
    def warnings(self) -> list[str]:
        """What is to be known before the answers; errors as `turning` and `motion`, which they need."""
        found = turn_too_far({self.speed: self.turning}, self.scene, self.h)
        _ = self.motion
        return found

    @cached_property
    def mechanism(self) -> Mechanism | None:
        """The mechanism of the scene, as fast as it is asked about; None without a scene."""
        return None if self.scene is None else compiled_mechanism(scene_at_speed(self.scene, self.speed))

    @cached_property
    def turning(self) -> TurningNormals | None:
        """How the normals of the scene's constraints turn; None without a scene; errors as `turning_of`."""
        return turning_of(self.scene, self.speed, self.h)


def meant_in_seconds(methods: Sequence[Method], point: Point, h: Fraction | None) -> bool:
    """Return whether numbers that were given as alpha_hat and beta_hat may be alpha and beta in 1/s.

    They may if no method is stable there and one of the numbers is above LARGE; and with a step (s) if errors then fall
    with some method, and not SLOWLY.
    """
    if max(point) > LARGE and not any(verdict(method, *point) == "converges" for method in methods):
        return True
    return h is not None and any(_settles(method, to_dimensionless(*point, h), h) for method in methods)


def _settles(method: Method, point: Point, h: Fraction) -> bool:
    """Return whether errors fall to a thousandth in less than SLOWLY, with steps of h (s)."""
    at_point = describe_point(method, "as given", *point, margins=False)
    return at_point.settle_steps is not None and at_point.settle_steps * h * method.step_multiple < SLOWLY


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
