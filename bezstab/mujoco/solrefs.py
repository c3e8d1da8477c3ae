"""Each solref and solimp of a model as Baumgarte's feedback of one constraint: its point, and whether it is safe.

Limits, frictions and contacts act only where a model gets to; what they do then is said here. MuJoCo's clamps, refsafe
and the impedance at no error are in the point; with `deep` the impedance past solimp's width, too.
"""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from bezstab.engines.acceleration_engines import LEAST_IMPEDANCE, MOST_IMPEDANCE
from bezstab.engines.engine_list import ENGINES
from bezstab.errors import InputError
from bezstab.methods.registry import lookup
from bezstab.methods.schemes import Method
from bezstab.methods.schur import Verdict
from bezstab.rationals import ZERO, exact
from bezstab.stability.drive_poles import drive_pole, drive_verdict

METHODS = {"Euler": "SYM", "RK4": "RK4", "implicit": "SYM", "implicitfast": "SYM"}
"""What MuJoCo's integrators, in the order of its own numbers, are for constraints."""

TIME_CONSTANTS = (2, 4, 8, 16, 32, 64)
"""Those of a solref to be written that are tried: in steps, critically damped."""

DEFAULT_SOLREF = (0.02, 1.0)
"""What MuJoCo takes where one number of solref is positive and the other not."""


@dataclass(frozen=True)
class Feedback:
    """One setting of constraints of some kinds: how many have it, its point, |z| of a step and the proven verdict.

    `notes` say what MuJoCo makes of the setting. (alpha_hat, beta_hat) is None, and so are the others, where the
    setting means nothing.
    """

    kinds: str
    setting: str
    count: int
    notes: str
    alpha_hat: float | None = None
    beta_hat: float | None = None
    z_abs: float | None = None
    verdict: Verdict | None = None

    @property
    def unsafe(self) -> bool:
        """Whether errors grow, or would at the smallest change; without damping they are only kept, at any step."""
        return self.verdict == "diverges" or (self.verdict == "marginal" and bool(self.alpha_hat))


def feedbacks(mujoco: Any, model: Any, *, deep: bool = False) -> Iterator[Feedback]:
    """Yield each different setting of the constraints that are switched on, the kinds that have it together."""
    found: dict[Feedback, list[tuple[str, int]]] = {}
    for each in _of_kinds(mujoco, model, deep):
        found.setdefault(replace(each, kinds="", count=0), []).append((each.kinds, each.count))
    for each, named in found.items():
        kinds, counts = zip(*named, strict=True)
        yield replace(each, kinds=", ".join(kinds), count=sum(counts))


def _of_kinds(mujoco: Any, model: Any, deep: bool) -> Iterator[Feedback]:
    method = lookup(list(METHODS.values())[model.opt.integrator])
    for kind, switch, wanted, solrefs, solimps in _settings(model):
        off = getattr(mujoco.mjtDisableBit, f"mjDSBL_{switch}") | mujoco.mjtDisableBit.mjDSBL_CONSTRAINT
        if model.opt.disableflags & off or not wanted.any():
            continue
        settings, counts = np.unique(np.hstack([solrefs, solimps])[wanted], axis=0, return_counts=True)
        for setting, count in zip(settings.tolist(), counts.tolist(), strict=True):
            yield from _feedback(mujoco, model, method, kind, setting, count, deep)


def _settings(model: Any) -> Iterator[tuple[str, str, Any, Any, Any]]:
    """Yield kinds: their name, their switch, which are there, and solref and solimp of each."""
    touches = (model.geom_contype != 0) | (model.geom_conaffinity != 0)
    yield "equality", "EQUALITY", np.ones(model.neq, bool), model.eq_solref, model.eq_solimp
    yield "joint limit", "LIMIT", model.jnt_limited != 0, model.jnt_solref, model.jnt_solimp
    yield "tendon limit", "LIMIT", model.tendon_limited != 0, model.tendon_solref_lim, model.tendon_solimp_lim
    yield "joint friction", "FRICTIONLOSS", model.dof_frictionloss != 0, model.dof_solref, model.dof_solimp
    rubs = model.tendon_frictionloss != 0
    yield "tendon friction", "FRICTIONLOSS", rubs, model.tendon_solref_fri, model.tendon_solimp_fri
    moves = np.full(model.ngeom, model.nv > 0)
    yield "contact", "CONTACT", touches & moves, model.geom_solref, model.geom_solimp
    yield "contact pair", "CONTACT", np.ones(model.npair, bool), model.pair_solref, model.pair_solimp


def _feedback(
    mujoco: Any, model: Any, method: Method, kind: str, setting: list[float], count: int, deep: bool
) -> Iterator[Feedback]:
    first, second, at_rest, largest, width = setting[:5]
    text = f'solref="{first:.9g} {second:.9g}" solimp="{at_rest:.9g} {largest:.9g} {width:.9g}"'
    notes, h = [], exact(model.opt.timestep)
    if (first > 0) != (second > 0):
        first, second = DEFAULT_SOLREF
        notes.append("the signs differ: MuJoCo takes 0.02 1")
    refsafe = not model.opt.disableflags & mujoco.mjtDisableBit.mjDSBL_REFSAFE
    if "friction" not in kind and refsafe and 0 < first < float(2 * h):
        notes.append(f"refsafe raises {first:g} s to 2h")
        first = float(2 * h)
    ends = np.clip([at_rest, largest], float(LEAST_IMPEDANCE), float(MOST_IMPEDANCE)).tolist()
    impedance = exact(ends[0]) if width > 0 else (exact(ends[0]) + exact(ends[1])) / 2
    ratio = impedance / exact(ends[1])
    try:
        alpha_hat, beta_hat = ENGINES["mujoco"].read(h, exact(first), exact(second))
    except (InputError, ArithmeticError, ValueError) as error:
        yield Feedback(kind, text, count, f"means nothing: {error}")
        return
    points = [(ratio * alpha_hat, ratio**2 * beta_hat), (alpha_hat, beta_hat)]
    if "friction" in kind:  # it has damping, but no position to be off
        points = [(alpha_hat, ZERO) for alpha_hat, _ in points[:1]]
    for (alpha_hat, beta_hat), where in zip(points if deep else points[:1], ("", "past its width"), strict=False):
        found = Feedback(
            kind,
            text,
            count,
            "; ".join([*notes, *[where] * bool(where)]),
            float(alpha_hat),
            float(beta_hat),
            float(np.abs(drive_pole(method, float(alpha_hat), float(beta_hat)))) ** (1 / float(method.step_multiple)),
            drive_verdict(method, alpha_hat, beta_hat),
        )
        if found.unsafe:  # (1, 1/4) of symplectic Euler and RK4 are stable, and so is what solimp makes of them
            advice = f'write solref="{float(2 * h):.9g} 1"'
            found = replace(found, notes="; ".join(filter(None, [found.notes, advice])))
        yield found
