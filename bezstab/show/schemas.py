"""What keys the rows of each command have, and that as a JSON Schema."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from bezstab.errors import InputError
from bezstab.show.vocabulary import VOCABULARY, Key, Kind

DIALECT = "https://json-schema.org/draft/2020-12/schema"


@dataclass(frozen=True)
class RowKind:
    """One kind of row that a command prints: what it is, the keys that it always has, those that options add.

    `sometimes` are keys that are null in some rows of this command, though elsewhere they never are.
    """

    title: str
    keys: tuple[str, ...]
    added: tuple[str, ...] = ()
    sometimes: tuple[str, ...] = ()


def _keys(text: str) -> tuple[str, ...]:
    return tuple(text.split())


POLE = "z_real z_imag z_abs z_angle_deg"
MOVING = _keys("kappa chi_abs z_abs_moving z_abs_worst double_pole settled moving_verdict safe_speed")
"""What --scene adds."""

REGION = """z_abs_below area alpha_hat_min alpha_hat_max beta_hat_min beta_hat_max approached best_z_abs
    best_alpha_hat best_beta_hat best_where best_reason bounded stable_for_all unconditional_damping_ratio
    critical_damping_limit critical_damping_limit_exact"""
METHOD = """method steps evaluations order order_position_forces order_velocity_forces error_constant
    error_constant_exact source implicit digits"""
COST = "omega_h forced_error total_error velocity_error order_left times_least times_least_velocity"
"""What accuracy the feedback costs."""
CHOICE = f"""method goal alpha_hat beta_hat verdict safe {POLE} worst searched h alpha beta settle_steps settle_seconds
    margins_reason h_factor h_limit alpha_factor_min alpha_factor_max beta_factor_min beta_factor_max
    {COST}"""

ACCURATE = _keys("omega_h accurate_alpha_hat accurate_beta_hat accurate_z_abs accurate_error best_error")
"""What --accuracy adds."""
APPLIED = ("applied", "excludes", "sweeps")
"""What --engine adds."""
DRIVE = _keys("drive kp kd inertia kp_max kd_max used_up")
"""What --pd adds."""
VARYING = _keys("varying varying_h_min varying_h_max hold certificate_kind certificate sequence growth shown_by")
"""What --h-min adds."""
LIKENESS = _keys("method predicted_z_abs predicted_z_angle_deg distance allowed dominant same_as judged_by fits")
LIKE_POINT = _keys("alpha_hat beta_hat alpha_hat_error beta_hat_error h alpha beta")

ROW_KINDS: Mapping[str, Sequence[RowKind]] = {
    "poles": [
        RowKind(
            "a pole of a method",
            _keys(f"method alpha_hat beta_hat {POLE} verdict safe {COST}"),
            (*APPLIED, *DRIVE, *MOVING),
        )
    ],
    "region": [
        RowKind("the region of a method", _keys(f"method {REGION}"), (*_keys("speed kappa area_moving"), *ACCURATE))
    ],
    "methods": [
        RowKind("a method in the list", _keys(f"{METHOD} group")),
        RowKind(
            "a method that was named",
            _keys(f"""{METHOD} recursion mapping characteristic_polynomial steady_error steady_velocity_error order_left
                {REGION}"""),
        ),
    ],
    "family": [
        RowKind(
            "a member of a family, or its limit",
            _keys("steps method area alpha_hat_max beta_hat_max best_z_abs order error_constant"),
        )
    ],
    "choose": [RowKind("a choice", _keys(CHOICE), ("setting", "sweeps", "engine_h_limit", *DRIVE, *MOVING, *VARYING))],
    "check": [
        RowKind(
            "a point, or what to take instead",
            _keys(f"role {CHOICE}"),
            (*APPLIED, "setting", "engine_h_limit", *DRIVE, *MOVING, *VARYING),
            sometimes=("excludes",),
        ),
        RowKind("the largest step of alpha and beta, without a step", _keys("role method alpha beta safe h_limit")),
    ],
    "lint": [
        RowKind(
            "an element of a model",
            _keys("element kind setting judged alpha_hat beta_hat map verdict safe z_abs h_factor advice"),
            sometimes=("alpha_hat", "beta_hat", "map", "verdict", "safe", "z_abs"),
        )
    ],
    "engines": [
        RowKind(
            "an engine",
            _keys("engine level method source excludes sweeps parameters optional units witness setting"),
            sometimes=("method",),
        )
    ],
    "simulate": [
        RowKind(
            "a run",
            _keys("""scene method run_evaluations failure least_pivot pivot_time iterations alpha_hat beta_hat h time
                c_max cdot_max energy_drift driver_work force_work singular_passages"""),
        )
    ],
    "verify": [
        RowKind(
            "a measured pole",
            _keys("""scene method alpha_hat beta_hat
                predicted_z_real predicted_z_imag predicted_z_abs predicted_z_angle_deg predicted_verdict
                law_z_abs law_verdict floquet_z_abs
                measured_z_real measured_z_imag measured_z_abs measured_z_angle_deg
                measured_rate measured_verdict
                difference_z_real difference_z_imag difference_z_abs difference_z_angle_deg
                reason measurable verdicts_agree right"""),
        ),
        RowKind(
            "a map of simulated verdicts",
            _keys(
                "scene method h run_steps runs undecided judged_runs agreeing agreeing_share band too_close farthest "
                "disagreeing"
            ),
        ),
        RowKind(
            "what a method forces on a mechanism",
            _keys("""scene method gain_share alpha_hat beta_hat h predicted_error measured_error quotient
                predicted_order observed_order reason"""),
        ),
        RowKind(
            "a run of an engine that is not ours",
            _keys("""scene integrator method alpha_hat beta_hat times_boundary predicted_z_abs predicted_verdict
                measured_verdict remaining run_steps"""),
        ),
    ],
    "probe": [
        RowKind(
            "the pole in a column of a log, or a method beside it, or a point at which a method has it",
            _keys("column z_real z_imag z_abs z_angle_deg uncertainty samples reason"),
            (*LIKENESS, *LIKE_POINT),
            sometimes=(*_keys("z_real z_imag z_abs z_angle_deg samples reason"), *LIKENESS, *LIKE_POINT),
        )
    ],
    "tradeoff": [
        RowKind(
            "a run of a method with a step",
            _keys("""method h alpha_hat beta_hat z_abs trajectory_error c_max measured_error predicted_error c_rms
                cdot_max cdot_rms energy_drift run_evaluations seconds seconds_min seconds_max failure observed_order
                front"""),
        ),
        RowKind(
            "the least error that a method can force with |z_p| at most so large",
            _keys("""method omega_h z_abs_below z_abs alpha_hat beta_hat h alpha beta total_error velocity_error
                combined_error"""),
        ),
    ],
    "extremes": [RowKind("a check", _keys("group case expected seen held"))],
    "paper": [RowKind("a claim of the paper", _keys("where claim paper here agreement"))],
}
"""The kinds of rows that each command prints."""

JSON_TYPES: Mapping[Kind, Mapping[str, Any]] = {
    "number": {"type": "number"},
    "integer": {"type": "integer"},
    "text": {"type": "string"},
    "truth": {"type": "boolean"},
    "numbers": {"type": "array", "items": {"type": "number"}},
    "text rows": {"type": "array", "items": {"type": "array", "items": {"type": "string"}}},
}


def json_schema(command: str) -> dict[str, Any]:
    """Return the JSON Schema of what a command prints with --format json: a list of rows, every key described.

    InputError, naming those that print rows, for another command.
    """
    if command not in ROW_KINDS:
        raise InputError(f"{command!r} prints no rows: expected one of {', '.join(ROW_KINDS)}")
    kinds = [_row_schema(kind) for kind in ROW_KINDS[command]]
    return {
        "$schema": DIALECT,
        "title": f"bezstab {command} --format json",
        "type": "array",
        "items": kinds[0] if len(kinds) == 1 else {"anyOf": kinds},
    }


def _row_schema(kind: RowKind) -> dict[str, Any]:
    """Return the schema of one kind of row: no key but its own, and those that it always has."""
    return {
        "title": kind.title,
        "type": "object",
        "properties": {
            name: _value_schema(VOCABULARY[name], name in kind.sometimes) for name in (*kind.keys, *kind.added)
        },
        "required": list(kind.keys),
        "additionalProperties": False,
    }


def _value_schema(key: Key, sometimes: bool) -> dict[str, Any]:
    """Return the schema of one value, which is null where the key says so, or `sometimes`."""
    schema: dict[str, Any] = {"description": key.description, **JSON_TYPES[key.kind]}
    may_be_null = bool(key.null) or sometimes
    if key.values:
        schema["enum"] = [*key.values, *([None] if may_be_null else [])]
    if may_be_null:
        schema["type"] = [schema["type"], "null"]
    return schema
