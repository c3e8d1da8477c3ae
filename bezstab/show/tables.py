"""Results as rows, and rows as text, Markdown, CSV, JSON or NPZ."""

from __future__ import annotations

import csv
import io
import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import fields
from fractions import Fraction
from functools import partial
from typing import TYPE_CHECKING, BinaryIO, Literal

import numpy as np

from bezstab.errors import InputError
from bezstab.methods import Method, accuracy, characteristic_text, evaluations, mapping_text, recursion_text, steps
from bezstab.paper.printed import LEAST_Z_ABS
from bezstab.show.columns import Column, Row, Value, formatted, pole_column
from bezstab.units import feedback_gains

if TYPE_CHECKING:  # so that a small table does not load what makes the large ones
    from _typeshed import DataclassInstance
    from numpy.typing import NDArray

    from bezstab.engines import Engine
    from bezstab.evidence import Measurement, VerdictMap
    from bezstab.mechanism import Observation, Trajectory
    from bezstab.methods import Verdict
    from bezstab.stability import BestPoint, Choice, FloatArray, Limit, Member, Region

Columns = Sequence[Column]


def _columns(text: str) -> Columns:
    """Return the columns named by `heading = key form; ...`, the form a format, one of FORMS, or none for text."""
    columns = []
    for each in text.split(";"):
        heading, _, what = each.strip().partition(" = ")
        key, _, form = what.partition(" ")
        columns.append(Column(heading, partial(_cell, key, form)))
    return columns


def _cell(key: str, form: str, row: Row) -> str:
    """Return what shows row[key], and a missing value as a dash."""
    return FORMS[form](row, key) if form in FORMS else formatted(row[key], form)


def _range(row: Row, key: str) -> str:
    low, high = row[f"{key}_factor_min"], row[f"{key}_factor_max"]
    return "-" if low is None else f"{low:.3g} to {'any' if high is None else format(high, '.3g')}"


def _milliseconds(row: Row, key: str) -> str:
    median, low, high = (row[name] for name in (key, f"{key}_min", f"{key}_max"))
    return f"{1e3 * median:.3g} ({1e3 * low:.3g} to {1e3 * high:.3g})"  # type: ignore[operator]


FORMS: Mapping[str, Callable[[Row, str], str]] = {
    "pole": lambda row, _: pole_column("").text(row),
    "modulus": lambda row, key: _cell(key, ".6f" if float(row[key] or 0) < 1e6 else ".6e", row),
    "range": _range,
    "limit": lambda row, key: str(row[key] or "limit"),
    "yes": lambda row, key: {True: "yes", False: "NO", None: "-"}[row[key]],  # type: ignore[index]
    "diverged": lambda row, key: "diverged" if row["failure"] else _cell(key, ".1e", row),
    "milliseconds": _milliseconds,
}

POLES = _columns("method = method; pole z = z pole; |z| = z_abs modulus; ∠z (deg) = z_angle_deg .3f; verdict = verdict")
METHODS = _columns(
    "method = method; steps = steps d; evaluations = evaluations d; order of accuracy = order d; "
    "error constant = error_constant; source = source"
)
PROPERTIES = _columns("property = property; value = value")
SIMULATIONS = _columns(
    "scene = scene; method = method; α̂ = alpha_hat .6g; β̂ = beta_hat .6g; h (s) = h g; until (s) = time .6g; "
    "largest |c| = c_max .3e; largest |ċ| = cdot_max .3e; energy drift (J) = energy_drift .3e; "
    "evaluations = evaluations d; least pivot = least_pivot .1e; at (s) = pivot_time .6g; failure = failure"
)
CHOICES = _columns(
    "method = method; goal = goal; α̂ = alpha_hat .6f; β̂ = beta_hat .6f; α (1/s) = alpha .6g; β (1/s) = beta .6g; "
    "verdict = verdict; |z_p| = z_abs .4f; ∠z_p (deg) = z_angle_deg .1f; within the spread = worst .4f; "
    "steps to 1/1000 = settle_steps d; s = settle_seconds .3g; stable for h (s) to = h_max .4g; α times = alpha range; "
    "β times = beta range"
)
FAMILY = _columns(
    "n = n limit; method = method; area = area .10g; α̂ to = alpha_hat_max .8g; β̂ to = beta_hat_max .8g; "
    "least |z_p| = z_abs .8f; order of accuracy = order d; error constant = error_constant .6f"
)
PASTE = _columns("to paste = engine")
ENGINES_LISTED = _columns(
    "engine = name; level = level; parameters = parameters; for this point = set; left out = excludes"
)
MEASUREMENTS = _columns(
    "method = method; α̂ = alpha_hat .6f; β̂ = beta_hat .6f; predicted |z| = predicted_abs .6f; "
    "measured |z| = measured_abs .6f; difference = difference_abs +.1e; predicted ∠z (deg) = predicted_angle_deg .3f; "
    "measured ∠z (deg) = measured_angle_deg .3f; difference (deg) = difference_angle_deg +.0e; "
    "predicted = predicted_verdict; measured = measured_verdict; verdicts agree = verdicts_agree yes; "
    "not measurable because = reason"
)
SUMMARIES = _columns(
    "method = method; points = points d; measured = measured d; median error of |z| = median_error .1e; "
    "largest = largest_error .1e; verdicts called = called d; of which wrong = wrong d"
)
VERDICT_MAPS = _columns(
    "scene = scene; method = method; runs = runs d; steps = run d; broke down = broken d; agreement = agreement .2%; "
    "too close to call: | |z_p| - 1 | below = band g; largest | |z_p| - 1 | that disagrees = farthest .2e; "
    "disagreeing beyond = disagreeing d"
)
WITNESSED = _columns(
    "scene = scene; MuJoCo's = integrator; method = method; α̂ = alpha_hat .4f; β̂ = beta_hat .4f; "
    "times the boundary = times_boundary g; predicted |z| = predicted_abs .4f; predicted = predicted_verdict; "
    "seen = measured_verdict; largest |c| at the end (m) = remaining .1e; after steps = steps d"
)
RUNS = _columns(
    "method = method; h (s) = h g; α̂ = alpha_hat .4g; β̂ = beta_hat .4g; |z_p| = z_abs .4f; "
    "trajectory error = trajectory_error diverged; order = order .2f; largest |c| = c_max .1e; rms = c_rms .1e; "
    "largest |ċ| = cdot_max .1e; rms ċ = cdot_rms .1e; energy drift (J) = energy_drift .1e; "
    "evaluations = evaluations d; time (ms) = seconds milliseconds; front = front s; failure = failure"
)
MAP_COSTS = _columns(
    "method = method; N = count d; quality = quality; time (s) = seconds .3g; memory (MB) = megabytes .3g; "
    "error of the area = area_error .1e; error of the boundary in α̂ = boundary_error .1e; "
    "largest = boundary_error_max .1e"
)
CHECKS = _columns("group = group; case = case; expected = expected; seen = seen; held = held yes")
REGIONS = _columns(
    "method = method; area = area .10g; α̂ from = alpha_hat_min .6g; α̂ to = alpha_hat_max .8g; "
    "β̂ to = beta_hat_max .8g; least |z_p| = best_z_abs .8f; at α̂ = best_alpha_hat .8f; at β̂ = best_beta_hat .8f; "
    "paper = paper_z_abs .2f; there = best_where"
)


def row(result: DataclassInstance, **more: Value) -> dict[str, Value]:
    """Return a result's numbers, texts and names, a complex number by its parts, angles in degrees, and more."""
    cells: dict[str, Value] = {}
    for each in fields(result):
        value = getattr(result, each.name)
        named = getattr(value, "name", value)
        if isinstance(value, complex):
            cells |= _parts("z_" if each.name == "pole" else f"{each.name}_", value)
        elif isinstance(value, Fraction):
            cells[each.name] = float(value)
        elif isinstance(named, str | float | int | None):
            cells[each.name] = named
    return {**cells, **more}


def pole_rows(
    method: Method, alpha_hat: float, beta_hat: float, poles: Iterable[complex], verdict: Verdict
) -> list[Row]:
    """Return a row for each pole of one method at one point, angles in degrees."""
    point: Row = {"method": method.name, "alpha_hat": alpha_hat, "beta_hat": beta_hat}
    return [{**point, **_parts("z_", complex(z)), "verdict": verdict} for z in poles]


def method_row(method: Method) -> Row:
    """Return steps, evaluations per step, order of accuracy, error constant (exact, as text) and source."""
    order, constant = accuracy(method)
    return {
        "method": method.name,
        "steps": steps(method),
        "evaluations": evaluations(method),
        "order": order,
        "error_constant": str(constant),
        "source": method.source,
    }


def whole_row(method: Method, region: Region, best: BestPoint | None, latex: bool) -> Row:
    """Return all that is known of one method; formulas as text or LaTeX."""
    return {**method_row(method), **formula_row(method, latex), **region_row(region, best)}


def formula_row(method: Method, latex: bool = False) -> Row:
    """Return one method's recursion, s->z mapping and characteristic polynomial (paper Tables 1 and 2)."""
    return {
        "method": method.name,
        "recursion": recursion_text(method, latex),
        "mapping": mapping_text(method, latex),
        "characteristic_polynomial": characteristic_text(method, latex),
    }


def transposed(row: Row) -> list[Row]:
    """Return one row per property, for reading a long row as text."""
    shown = {
        key: "-" if value is None else f"{value:.10g}" if isinstance(value, float) else str(value)
        for key, value in row.items()
    }
    return [{"property": key.replace("_", " "), "value": value} for key, value in shown.items()]


def region_row(region: Region, best: BestPoint | None) -> Row:
    """Return area, axis limits and best point, with what the paper has for it; None where the region is empty."""
    (alpha_min, alpha_max), (_, beta_max) = region.extent or ((None, None), (None, None))
    return {
        "method": region.method.name,
        "area": region.area,
        "alpha_hat_min": alpha_min,
        "alpha_hat_max": alpha_max,
        "beta_hat_max": beta_max,
        "best_z_abs": best.z_abs if best else None,
        "best_alpha_hat": best.alpha_hat if best else None,
        "best_beta_hat": best.beta_hat if best else None,
        "best_where": where(best) if best else None,
        "paper_z_abs": LEAST_Z_ABS.get(region.method.name),
    }


def where(best: BestPoint) -> str:
    """Return in words which poles meet at the best point, and where else |z_p| is as small."""
    if best.z_abs == 0:
        words = "deadbeat: every pole is 0"
    else:
        poles = " and ".join(f"{z.real:+.6f}{f' ± {z.imag:.6f}i' if z.imag else ''}" for z in best.meeting)
        words = f"z = {poles}{' meet' if len(best.meeting) > 1 else ''}"
        words += ", each double, on β̂ = α̂²/4" if best.double else ""
    points = " and ".join(f"({a:.6f}, {b:.6f})" for a, b in best.elsewhere)
    if best.arc:
        return f"{words}; the same |z_p| on a whole arc, to {points}"
    return f"{words}; also at {points}" if points else words


def simulation_row(run: Trajectory, seen: Observation, alpha_hat: float, beta_hat: float, h: float) -> Row:
    """Return the summary of one run: largest |c| and |cdot|, energy drift (J), evaluations, when and why it failed."""
    return {
        "scene": run.mechanism.scene.name,
        **row(run, alpha_hat=alpha_hat, beta_hat=beta_hat, h=h, time=float(run.t[-1])),
        "c_max": float(np.abs(seen.c).max()),
        "cdot_max": float(np.abs(seen.cdot).max()),
        "energy_drift": float(seen.energy[-1] - seen.energy[0]),
    }


def measurement_row(scene: str, measurement: Measurement) -> Row:
    """Return predicted and measured dominant pole at one point, angles in degrees."""
    predicted = _parts("", measurement.predicted)
    measured = None if measurement.measured is None else _parts("", measurement.measured)
    diverges = [v == "diverges" for v in (measurement.predicted_verdict, measurement.measured_verdict)]
    return {
        **row(measurement, scene=scene, measurable=measured is not None),
        **{f"measured_{key}": measured[key] if measured else None for key in predicted},
        **{f"difference_{key}": measured[key] - predicted[key] if measured else None for key in predicted},
        "verdicts_agree": None if measurement.measured_verdict == "too close to call" else diverges[0] == diverges[1],
    }


def summary_row(rows: Sequence[Row]) -> Row:
    """Return how well the measured poles of one method agree: errors of |z|, and verdicts that contradict theory."""
    errors = [abs(row["difference_abs"]) for row in rows if isinstance(row["difference_abs"], float)]
    return {
        "method": rows[0]["method"],
        "points": len(rows),
        "measured": len(errors),
        "median_error": float(np.median(errors)) if errors else None,
        "largest_error": max(errors, default=None),
        "called": sum(row["verdicts_agree"] is not None for row in rows),
        "wrong": sum(row["verdicts_agree"] is False for row in rows),
    }


def verdict_map_row(verdicts: VerdictMap) -> Row:
    """Return how far simulated verdicts agree with |z_p| < 1, and how near to one those lie that do not."""
    distance = np.abs(verdicts.z_abs - 1)[verdicts.disagrees]
    judged = verdicts.broken.size - int(verdicts.broken.sum())
    return row(
        verdicts,
        runs=verdicts.broken.size,
        broken=int(verdicts.broken.sum()),
        agreement=1 - distance.size / judged if judged else None,
        band=verdicts.band,
        farthest=float(distance.max()) if distance.size else None,
        disagreeing=int((distance > verdicts.band).sum()),
    )


def untimed(rows: Sequence[Row]) -> dict[str, NDArray[np.generic]]:
    """Return rows as columns without processor times, which no two runs share; what is missing is nan or empty."""
    keys = [key for key in rows[0] if not key.startswith("seconds")]
    return {key: np.array([_present(key, row[key]) for row in rows]) for key in keys}


def _present(key: str, value: Value) -> Value:
    return ("" if key in ("failure", "front") else math.nan) if value is None else value


def choice_row(choice: Choice, h: float | None) -> dict[str, Value]:
    """Return a point, in 1/s too with h (s), how fast it settles and by what it may be off; None for no limit."""
    margins, settle = choice.margins, choice.settle_steps
    two_alpha, beta_squared = feedback_gains(choice.alpha_hat, choice.beta_hat, h or 1.0)
    (a_min, a_max), (b_min, b_max) = (margins.alpha, margins.beta) if margins else ((None, None), (None, None))
    return row(
        choice,
        h=h,
        alpha=two_alpha / 2 if h else None,
        beta=math.sqrt(beta_squared) if h and beta_squared >= 0 else None,
        settle_steps=settle,
        settle_seconds=settle * h * float(choice.method.step_multiple) if settle is not None and h else None,
        h_factor=margins.h if margins else None,
        h_max=margins.h * h if margins and h else None,
        alpha_factor_min=a_min,
        alpha_factor_max=a_max,
        beta_factor_min=b_min,
        beta_factor_max=b_max,
    )


def family_row(member: Member | Limit) -> Row:
    """Return what has become of a family at its number of steps, or in its limit, which has no n."""
    from bezstab.stability import Limit

    if isinstance(member, Limit):
        return row(member, n=None, method="B∞", order=2)
    (_, alpha_max), (_, beta_max) = member.region.extent or ((None, None), (None, None))
    return row(member, area=member.region.area, alpha_hat_max=alpha_max, beta_hat_max=beta_max)


def engine_row(engine: Engine, point: tuple[Fraction, Fraction] | None, h: Fraction) -> Row:
    """Return an engine's words, and what to set for a point at a step of h (s), or why nothing will do."""
    try:
        setting = engine.setting(point, h) if point else None
    except InputError as error:
        setting = str(error)
    return row(engine, parameters=", ".join(engine.parameters), set=setting)


def _parts(name: str, z: complex) -> dict[str, float]:
    parts = {"real": z.real, "imag": z.imag, "abs": abs(z), "angle_deg": float(np.degrees(np.angle(z)))}
    return {f"{name}{key}": value for key, value in parts.items()}


def verdict_columns(verdicts: VerdictMap) -> dict[str, NDArray[np.generic]]:
    """Return a map of verdicts as columns, alpha_hat running fastest; 1 for diverges, 1 for broken."""
    a, b = np.meshgrid(verdicts.alpha_hat, verdicts.beta_hat)
    columns = {"alpha_hat": a, "beta_hat": b, "z_abs": verdicts.z_abs}
    masks = {"diverges": verdicts.diverges.astype(int), "broken": verdicts.broken.astype(int)}
    return {key: column.ravel() for key, column in {**columns, **masks}.items()}


def history_columns(run: Trajectory, seen: Observation) -> dict[str, NDArray[np.generic]]:
    """Return t, q, qdot, c, cdot, lambda and energy as columns, SI units."""
    columns: dict[str, NDArray[np.generic]] = {"t": run.t}
    for prefix, rows in (("", run.q), ("d/dt ", run.v)):
        columns |= {f"{prefix}{name}": rows[:, i] for i, name in enumerate(run.mechanism.scene.coordinates)}
    for name, rows in (("c", seen.c), ("cdot", seen.cdot), ("lambda", seen.multipliers)):
        columns |= {f"{name}_{i}": column for i, column in enumerate(rows.T, start=1)}
    return {**columns, "energy": seen.energy}


def map_columns(
    alpha_hat: FloatArray, beta_hat: FloatArray, z: NDArray[np.complex128], h: float | None
) -> dict[str, NDArray[np.generic]]:
    """Return a pole map as columns, alpha_hat running fastest; with h (s) also 2 alpha and beta^2 in 1/s and 1/s^2."""
    a, b = np.meshgrid(alpha_hat, beta_hat)
    columns = {"alpha_hat": a, "beta_hat": b, "z_abs": np.abs(z), "z_angle_deg": np.degrees(np.angle(z))}
    return {key: column.ravel() for key, column in {**columns, **_physical(a, b, h)}.items()}


def boundary_columns(regions: Sequence[Region], h: float | None) -> dict[str, NDArray[np.generic]]:
    """Return the boundary curves as columns: method, number of the closed curve, the point; with h as above."""
    curves = [(region.method.name, number, curve) for region in regions for number, curve in enumerate(region.boundary)]
    names = np.array([name for name, _, curve in curves for _ in curve], dtype=np.str_)
    numbers = np.array([number for _, number, curve in curves for _ in curve], dtype=np.int64)
    a, b = np.concatenate([np.empty((0, 2)), *(curve for *_, curve in curves)]).T
    return {"method": names, "curve": numbers, "alpha_hat": a, "beta_hat": b, **_physical(a, b, h)}


def _physical(alpha_hat: FloatArray, beta_hat: FloatArray, h: float | None) -> dict[str, FloatArray]:
    if h is None:
        return {}
    two_alpha, beta_squared = feedback_gains(alpha_hat, beta_hat, h)
    return {"two_alpha": two_alpha, "beta_squared": beta_squared}


def write_columns(columns: Mapping[str, NDArray[np.generic]], form: Literal["csv", "npz"], file: BinaryIO) -> None:
    """Write equally long columns: CSV with every digit of float64, or NPZ with one array per name."""
    if form == "npz":
        np.savez_compressed(file, **columns)  # type: ignore[arg-type]  # its options have other names
        return
    text = io.TextIOWrapper(file, encoding="utf-8", newline="", write_through=True)
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(columns)
    writer.writerows(zip(*(column.tolist() for column in columns.values()), strict=True))
    text.detach()
