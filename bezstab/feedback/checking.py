"""Is this feedback safe, and what does it cost? A point of yours, or an engine's own values, judged.

methods, point or values of an engine, Conditions   →   checks   →   CheckAnswer, by method and point
method, alpha and beta in 1/s, no step              →   largest_steps   →   StepAnswer
"""

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction

from bezstab.arguments import Number, exact_number, exact_or_none, in_keywords, plane_point, point_if_given, real_number
from bezstab.engines.conversions import Applied, Point
from bezstab.engines.engine_list import engine_and_values
from bezstab.errors import InputError, NumericalError
from bezstab.feedback.choosing import ChooseAnswer, Wish, check_motion, choose_answer
from bezstab.feedback.conditions import Conditions, Setup, conditions, for_choosing
from bezstab.feedback.judgement import AS_GIVEN, Judgement, judge
from bezstab.feedback.sentences import judgement_sentence, step_sentence
from bezstab.mechanism.scene_files import scene as scene_named
from bezstab.mechanism.scenes import Scene
from bezstab.methods.registry import method as method_named
from bezstab.methods.schemes import Method
from bezstab.questions.methods import methods_for, usual_goal
from bezstab.stability.choices import USUAL_SPREAD, describe_point
from bezstab.stability.damping_limits import stable_up_to


@dataclass(frozen=True, kw_only=True, repr=False)
class CheckAnswer(Judgement):
    """A point that was given, judged.

    instead: what `choose` gives in its place; None unless asked for, and where there is none: `instead_reason` says
    why. sentence: the answer in words.
    """

    instead: ChooseAnswer | None
    instead_reason: str | None
    sentence: str

    def __repr__(self) -> str:
        return f"{self.sentence} [{self.method.name}, {self.goal}, |z_p| = {abs(self.pole):.6g}]"


@dataclass(frozen=True, kw_only=True)
class Given:
    """The point that is judged, or the `values` of an engine, which makes points of them; `as_typed` without clamps.

    InputError unless it is one of the two.
    """

    point: Point | None = None
    values: tuple[Fraction, ...] | None = None
    as_typed: bool = False

    def __post_init__(self) -> None:
        if self.as_typed and self.values is None:
            raise InputError("--as-typed needs --engine: it leaves out what that engine does to its values")
        if self.values is not None and self.point is not None:
            raise InputError("--engine takes the place of --alpha, --beta and --physical")
        if self.values is None and self.point is None:
            raise InputError("a point is needed: --alpha with --beta, or --engine")


@in_keywords()
def check(
    method: str | Method | None = None,
    *,
    alpha_hat: Number | None = None,
    beta_hat: Number | None = None,
    alpha: Number | None = None,
    beta: Number | None = None,
    h: Number | None = None,
    engine: str | None = None,
    as_typed: bool = False,
    omega: Number | None = None,
    omega_h: Number | None = None,
    scene: str | Scene | None = None,
    speed: Number = 1,
    duration: Number | None = None,
    spread: float = USUAL_SPREAD,
    load: Number | None = None,
    margins: bool = True,
    cost: bool = True,
    instead: bool = False,
) -> CheckAnswer:
    """Return whether a feedback of your own is safe, how fast errors decay, and how far alpha, beta and h may go.

    Parameters
    ----------
    method : str or Method, optional
        The integration method; by default the engine's own.
    alpha_hat, beta_hat : number or str, optional
        The feedback, dimensionless, read as written.
    alpha, beta, h : number or str, optional
        In their place: the feedback in 1/s and the step (s).
    engine : str, optional
        In their place: an engine's own values, such as "mujoco=0.02,1", with h.
    as_typed : bool
        Whether to leave out the engine's clamps.
    omega, omega_h : number, optional
        Rate of the motion in 1/s, or in rad a step. With one of them or a scene, `cost` compares the error that the
        feedback makes with the least one; with omega, `energy_rate` says what it does to the motion.
    scene, speed, duration : str or Scene, number, number, optional
        A mechanism that moves so many times as fast as given there, and for how long (s) it is run.
    spread : float
        The share by which alpha and beta may be wrong, for `worst`.
    load : number, optional
        A steady load over the mass that it acts on (m/s^2 or rad/s^2), for `sag`: in an engine.
    margins, cost, instead : bool
        Whether to find how far h, alpha and beta may each go alone, the errors on the motion, and what `choose` gives.

    Returns
    -------
    CheckAnswer
        True if safe. `sentence` says it in words, `verdict` is proven. Of several points that an engine makes of its
        values, the first that is not safe.

    Raises
    ------
    InputError
        The point is not given in one of these ways, or a number is out of range.
    NumericalError
        A pole leaves the range of float64.

    References
    ----------
    The Schur-Cohn test (I. Schur, J. reine angew. Math. 147, 1917) on the polynomial of the paper's Eq. 17.
    """
    named, values = (None, None) if engine is None else engine_and_values(engine)
    given_point = point_if_given if engine else plane_point
    point = given_point(alpha_hat, beta_hat, alpha, beta, h)
    given = Given(point=point, values=values, as_typed=as_typed)
    setup = Setup(
        h=exact_or_none(h, "h"),
        engine=named,
        omega=exact_or_none(omega, "omega"),
        omega_h=exact_or_none(omega_h, "omega_h"),
        scene=None if scene is None else scene_named(scene),
        speed=exact_number(speed, "speed"),
        duration=exact_or_none(duration, "duration"),
        spread=real_number(spread, "spread"),
        load=exact_or_none(load, "load"),
    )
    methods = methods_for(() if method is None else (method_named(method),), named)
    found = checks(methods, given, conditions(setup), margins=margins, cost=cost, instead=instead)
    return next((answer for answer in found if not answer.safe), found[0])


def made_points(given: Given, asked: Conditions) -> Applied:
    """Return the point that is judged, and those at which an engine's values must be safe, too."""
    if given.values is not None and asked.engine and asked.h is not None:
        return asked.engine.applied(given.values, asked.h, as_typed=given.as_typed)
    assert given.point
    return Applied(given.point, None)


def checks(
    methods: Sequence[Method],
    given: Given,
    asked: Conditions,
    *,
    margins: bool = True,
    cost: bool = True,
    instead: bool = False,
    instead_of_unsafe: bool = False,
) -> list[CheckAnswer]:
    """Return the answer of each method for the point, and for those that an engine also takes; errors as `judge`.

    What to take instead stands in the first answer of a method: if asked for, or with `instead_of_unsafe` where one of
    the method's answers is not safe.
    """
    made, found = made_points(given, asked), []
    for method in methods:
        judged = [
            judge(
                asked,
                describe_point(method, label, *point, asked.spread, margins),
                "given",
                values=given.values,
                applied=made.words if asked.engine and label == AS_GIVEN else None,
                as_typed=given.as_typed,
                margins=margins,
                cost=cost,
            )
            for label, point in ((AS_GIVEN, made.point), *made.also)
        ]
        better, reason = None, None
        if instead or (instead_of_unsafe and not all(judged)):
            try:
                better = _instead(method, asked)
            except (InputError, NumericalError) as error:  # the verdict stands without it
                reason = str(error)
        for number, each in enumerate(judged):
            first = number == 0
            found.append(
                CheckAnswer(
                    **vars(each),
                    instead=better if first else None,
                    instead_reason=reason if first else None,
                    sentence=judgement_sentence(each),
                )
            )
    return found


def _instead(method: Method, asked: Conditions) -> ChooseAnswer:
    """Return what `choose` gives for the same conditions by its usual goal.

    InputError where nothing is stable or the engine cannot express it, NumericalError where it cannot be found.
    """
    goal = usual_goal(asked.engine, (method,))
    if goal == "accurate":
        check_motion(method, asked)
    return choose_answer(method, Wish(goal), for_choosing(asked), "instead")


@dataclass(frozen=True, repr=False)
class StepAnswer:
    """The step (s) up to which every step is stable with a method, alpha and beta (1/s): infinite if all are.

    safe: whether small steps are stable at all; else h_limit is zero.
    """

    method: Method
    alpha: float
    beta: float
    h_limit: float
    safe: bool
    sentence: str

    def __repr__(self) -> str:
        return self.sentence

    def __bool__(self) -> bool:
        return self.safe


@in_keywords()
def largest_step(method: str | Method, *, alpha: Number, beta: Number) -> float:
    """Return the step (s) up to which every step is stable with alpha and beta.

    Parameters
    ----------
    method : str or Method
        The integration method.
    alpha, beta : number or str
        The feedback in 1/s.

    Returns
    -------
    float
        Infinite if every step is stable, 0 if small ones are not. The verdict is proven on both sides.

    Raises
    ------
    InputError
        A number is not finite.

    References
    ----------
    The path of all steps through the plane of the paper's Eq. 17.
    """
    return stable_up_to(method_named(method), exact_number(alpha, "alpha"), exact_number(beta, "beta"))


def step_answer(method: Method, alpha: Fraction, beta: Fraction) -> StepAnswer:
    """Return up to which step alpha and beta (1/s) are stable, as an answer."""
    return _step_answer(method, float(alpha), float(beta), stable_up_to(method, alpha, beta))


def step_answer_of(chosen: ChooseAnswer) -> StepAnswer:
    """Return the same of a choice whose alpha and beta do not depend on the step."""
    assert chosen.alpha is not None
    assert chosen.beta is not None
    return _step_answer(chosen.method, chosen.alpha, chosen.beta, chosen.h_limit or 0.0)


def _step_answer(method: Method, alpha: float, beta: float, h_limit: float) -> StepAnswer:
    return StepAnswer(method, alpha, beta, h_limit, h_limit > 0, step_sentence(alpha, beta, h_limit))
