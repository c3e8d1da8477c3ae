"""What does a mechanism do, with a method, its steps, and what holds its constraints?

scene, method, steps, feedback or projection   →   run_of   →   Simulation
"""

from collections.abc import Sequence
from fractions import Fraction

from bezstab.arguments import Number, exact_number, in_keywords, plane_point
from bezstab.engines.conversions import Point
from bezstab.errors import InputError
from bezstab.mechanism.equations import Mechanism, compiled_mechanism
from bezstab.mechanism.runner import Start
from bezstab.mechanism.scene_files import scene as scene_named
from bezstab.mechanism.scenes import Scene
from bezstab.mechanism.simulation import Simulation, simulated
from bezstab.methods.registry import method as method_named
from bezstab.methods.schemes import Method, check_one_step
from bezstab.stabilising import Stabilise, after_step


@in_keywords()
def simulate(
    scene: str | Scene,
    method: str | Method,
    *,
    h: Number,
    duration: Number,
    start: Start = "rk4",
    perturb: Number = 0,
    stabilise: Stabilise = "baumgarte",
    iterations: int | None = None,
    alpha_hat: Number | None = None,
    beta_hat: Number | None = None,
    alpha: Number | None = None,
    beta: Number | None = None,
) -> Simulation:
    """Return a run of a mechanism with a method and a feedback, as arrays in SI units.

    Parameters
    ----------
    scene : str or Scene
        The mechanism: a shipped scene, the path of a .toml file, or what `bezstab.scene` returns.
    method : str or Method
        The integration method.
    h : number
        Step (s).
    duration : number
        Length of the run (s), at least one step.
    start : {"rk4", "ramp", "euler", "steady"}
        How a multistep method gets its first values: by RK4, by members of its family with fewer steps, or by explicit
        Euler. "steady" begins with the method's own velocity in the long run: for symplectic Euler half a step back.
    perturb : number
        Initial error of the first constraint, in its own unit.
    stabilise : {"baumgarte", "projection", "none"}
        What holds the constraints: feedback, projection of each new state onto them, or nothing. Only feedback has a
        point.
    iterations : int, optional
        With projection: at most so many Newton iterations for a position; by default as many as reach 1e-12.
    alpha_hat, beta_hat : number, optional
        The feedback, dimensionless.
    alpha, beta : number, optional
        The same in 1/s, in their place.

    Returns
    -------
    Simulation
        `t` has shape (steps + 1,), as `energy` has; `q`, `v`, `c`, `cdot` and `multipliers` have a row for each time. A
        run that breaks down ends early, and `failure` says when and why; else it is None.

    Raises
    ------
    InputError
        The scene cannot start, the duration is below one step, or the feedback is not given in one of the two ways.
    NumericalError
        The start cannot be perturbed.

    References
    ----------
    The paper's Eqs. 6 to 9.
    """
    return run_of(
        compiled_mechanism(scene_named(scene)),
        method_named(method),
        h=exact_number(h, "h"),
        duration=exact_number(duration, "duration"),
        point=plane_point(alpha_hat, beta_hat, alpha, beta, h, needed=stabilise == "baumgarte"),
        start=start,
        perturb=exact_number(perturb, "perturb"),
        stabilise=stabilise,
        iterations=iterations,
    )


def run_of(
    mechanism: Mechanism,
    method: Method,
    *,
    h: Fraction,
    duration: Fraction,
    point: Point | None,
    stabilise: Stabilise = "baumgarte",
    iterations: int | None = None,
    sequence: Sequence[Fraction] = (),
    hold: bool = False,
    perturb: Fraction = Fraction(0),
    start: Start = "rk4",
) -> Simulation:
    """Return a run over a duration (s) with the feedback of a point (alpha_hat, beta_hat), or with what else holds it.

    Steps are h (s), or a sequence (s), over and over: then alpha and beta stay as steps vary, with `hold` alpha_hat and
    beta_hat do. InputError for what does not go together, for a method whose states cannot be projected or whose steps
    cannot vary, and as `simulated`; what goes wrong on the way is the run's `failure`.
    """
    after = after_step(stabilise, iterations)
    if sequence:
        check_one_step(method)
    elif hold:
        raise InputError("--hold needs --steps: it is about steps that vary")
    if (point is None) == (stabilise == "baumgarte") or (hold and point is None):
        raise InputError("--alpha and --beta are those of feedback: they go with --stabilise baumgarte, as does --hold")
    alpha_hat, beta_hat = map(float, point or (0, 0))
    return simulated(
        mechanism,
        method,
        h=float(h),
        duration=float(duration),
        alpha_hat=alpha_hat,
        beta_hat=beta_hat,
        perturb=float(perturb),
        start=start,
        after=after,
        sequence=[float(step) for step in sequence],
        hold=hold,
    )
