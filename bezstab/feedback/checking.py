"""Is this feedback safe, and what does it cost? A point of yours, or an engine's own values, judged.

methods, Conditions   →   checks        →   Judgement, by method and point
method, alpha, beta   →   step_answer   →   StepAnswer: up to which step, where none is given
"""

import math
from dataclasses import dataclass, replace
from fractions import Fraction

from bezstab.arguments import Number, exact_number, in_keywords, plane_point
from bezstab.engines.engine_list import engine_and_values
from bezstab.errors import InputError, NumericalError
from bezstab.feedback.choosing import check_motion, choose_answer
from bezstab.feedback.conditions import AS_GIVEN, Conditions, conditions, for_choosing, setup_in_python
from bezstab.feedback.judgement import Judgement, judge
from bezstab.feedback.sentences import judgement_sentence
from bezstab.mechanism.scenes import Scene
from bezstab.methods.registry import method as method_named
from bezstab.methods.schemes import Method
from bezstab.questions.methods import methods_for, usual_goal
from bezstab.rationals import rounded_down
from bezstab.stability.choices import USUAL_SPREAD, describe_point
from bezstab.stability.closed_loop import poles
from bezstab.stability.path_ends import stable_up_to


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
) -> Judgement:
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
    Judgement
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
    setup = setup_in_python(
        scene,
        speed,
        spread,
        {"h": h, "omega": omega, "omega_h": omega_h, "duration": duration, "load": load},
        engine=named,
        point=plane_point(alpha_hat, beta_hat, alpha, beta, h, needed=named is None),
        values=values,
        as_typed=as_typed,
        margins=margins,
        cost=cost,
    )
    found = checks(() if method is None else (method_named(method),), conditions(setup), instead=instead)
    return next((answer for answer in found if not answer.safe), found[0])


def checks(methods: tuple[Method, ...], asked: Conditions, *, instead: bool | None = False) -> list[Judgement]:
    """Return the answer of each method, else of the engine's own, for the point, and for those that it also takes.

    What to take instead stands in the first answer of a method: if asked for, and with None where one of the method's
    answers is not safe. InputError without a point, and as `methods_for`; else errors as `judge`.
    """
    if asked.made is None:
        raise InputError("a point is needed: --alpha with --beta, or --engine")
    found = []
    for method in methods_for(methods, asked.engine):
        judged = [
            judge(asked, describe_point(method, label, *point, asked.spread), "given")
            for label, point in ((AS_GIVEN, asked.made.point), *asked.made.also)
        ]
        if instead or (instead is None and not all(judged)):
            try:
                judged[0] = replace(judged[0], instead=_instead(method, asked))
            except (InputError, NumericalError) as error:  # the verdict stands without it
                judged[0] = replace(judged[0], instead_reason=str(error))
        found += [replace(each, sentence=judgement_sentence(each)) for each in judged]
    return found


def poles_at(methods: tuple[Method, ...], asked: Conditions, *, every: bool = False) -> list[Judgement]:
    """Return the point that is given, judged, with the dominant pole of each method, or with each of them in turn.

    Of a pair the upper one stands for both. Errors as `judge`.
    """
    dominant = [each for each in checks(methods, asked) if each.goal == AS_GIVEN]
    if not every:
        return dominant
    part = "Each step multiplies this pole's part of the error by |z|."
    return [
        replace(each, pole=complex(z), sentence=f"{each.method.name} {each.verdict}. {part}")
        for each in dominant
        for z in poles(each.method, each.alpha_hat, each.beta_hat)
        if z.imag >= 0
    ]


def _instead(method: Method, asked: Conditions) -> Judgement:
    """Return what `choose` gives for the same conditions by its usual goal.

    InputError where nothing is stable or the engine cannot express it, NumericalError where it cannot be found.
    """
    asked = replace(for_choosing(asked), goal=usual_goal(asked.engine, (method,)))
    check_motion(method, asked)
    return choose_answer(method, asked, "instead")


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


def step_answer(method: Method, alpha: Fraction, beta: Fraction) -> StepAnswer:
    """Return up to which step every one is stable with alpha and beta (1/s). In its sentence it is rounded down."""
    h_limit = stable_up_to(method, alpha, beta)
    safe = "not safe at small steps"
    if h_limit:
        safe = "safe at any h" if math.isinf(h_limit) else f"safe up to h = {limit_words(h_limit)} s"
    sentence = f"α = {float(alpha):.6g} 1/s, β = {float(beta):.6g} 1/s: {safe}."
    return StepAnswer(method, float(alpha), float(beta), h_limit, h_limit > 0, sentence)


def limit_words(h_limit: float) -> str:
    """Return such a step (s) to four digits, rounded down; it is known to a part in 1e9, so 0.04 is not 0.03999."""
    return rounded_down(float(f"{h_limit:.9g}"), 4)


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
