"""What a cell of a table shows where it takes more than a format: texts made of a row."""

from decimal import ROUND_FLOOR, Context

from bezstab.show.fields import MISSING, Row, Text, formatted

MOST_FIXED = 1e6  # a modulus from here on is shown with an exponent

LIMITS = ("alpha_hat_min", "alpha_hat_max", "beta_hat_min", "beta_hat_max")
"""The ends of a region's ranges, as rows name them."""

ENDS = ("area", *LIMITS)
"""What an unbounded region lacks."""

WITHOUT_LIMIT = {"critical_damping_limit": "unlimited", "unconditional_damping_ratio": "none"}
"""What is said where all steps are stable, or only those that are small enough."""


def pole_text(row: Row) -> str:
    """Return a complex pole, from z_real and z_imag: 0.762694 ± 0.142074i; a dash where there is none."""
    real, imaginary = row["z_real"], row["z_imag"]
    if real is None:
        return MISSING
    form = ".6f" if max(abs(real), imaginary) < MOST_FIXED else ".6e"
    visible = round(imaginary / max(1, abs(real)), 6) != 0
    return f"{real:{form}} ± {imaginary:{form}}i" if visible else f"{real:{form}}"


def modulus_words(modulus: float) -> str:
    """Return |z|: six decimals, or an exponent where it is huge."""
    return formatted(modulus, ".6e" if modulus >= MOST_FIXED else ".6f")


def any_step(row: Row) -> str:
    """Return what is said of the step where it has no largest factor: any where no end is, none where no step is."""
    return {None: MISSING, "diverges": "none"}.get(row["verdict"], "any")


def any_speed(row: Row) -> str:
    """Return what is said of a mechanism's speed where it has no limit: any, where it does not turn."""
    return "any" if row["moving_verdict"] == "converges" else MISSING


def any_gain(row: Row) -> str:
    """Return what is said of a gain that has no limit: any, or that none helps."""
    return "any" if row["verdict"] == "converges" else "none helps"


def range_text(gain: str) -> Text:
    """Return the text of the factors by which a gain may be scaled: 0.45 to 1.6; without an upper end, to any."""

    def text(row: Row) -> str:
        low, high = row[f"{gain}_factor_min"], row[f"{gain}_factor_max"]
        if low is None:
            return MISSING
        return f"{low:.3g} to any" if high is None else f"{low:.3g} to {high:.3g}"

    return text


def step_limit(row: Row) -> float | None:
    """Return the largest stable step (s): of an engine's values where those were given, else of alpha and beta."""
    limit: float | None = row["engine_h_limit" if "engine_h_limit" in row else "h_limit"]
    return limit


def step_text(row: Row) -> str:
    """Return the largest stable step; a stable point without one is stable at any."""
    limit = step_limit(row)
    known = row["verdict"] == "converges" and row["margins_reason"] is None
    if limit is None and row["h"] is not None and known:
        return "unlimited"
    return formatted(limit, ".4g")


def used_up_text(row: Row) -> str:
    """Return which gain is nearest its limit, and how much of that it is."""
    gain = row["used_up"]
    if gain is None:
        return MISSING
    value, limit = row[gain], row[f"{gain}_max"]
    if value is None or not limit:  # out of range, or none of it
        return str(gain)
    return f"{gain} {100 * value / limit:.0f} %"


def unbounded_text(key: str, form: str) -> Text:
    """Return the text of a region's area or of a limit: in words where there is none.

    A limit that the region only comes near, far out, is called "approached".
    """

    def text(row: Row) -> str:
        value = row[key]
        if value is None:
            return "unbounded" if key in ENDS and not row.get("bounded", True) else WITHOUT_LIMIT.get(key, MISSING)
        near = key in (row.get("approached") or "").split(", ")
        return f"{value:.8g} (approached)" if near else formatted(value, form)

    return text


def stable_steps_text(row: Row) -> str:
    """Return up to which beta h all steps are stable at alpha = beta, and what all of them need."""
    ratio, limit = row["unconditional_damping_ratio"], row["critical_damping_limit"]
    if limit is not None:
        exact = row["critical_damping_limit_exact"]
        return f"{limit:.6g} = {exact}" if exact and "/" in exact else f"{limit:.6g}"
    if row["stable_for_all"] == "proven":
        return "all (proven for any α, β)"
    if ratio is None:
        return "all"
    return f"all, as from α/β = {ratio:.6g}" if ratio else "all (no unstable α, β found)"


def order_text(row: Row) -> str:
    """Return the order of accuracy, with that for forces of position alone in parentheses if it is another."""
    order = row["order"]
    without_velocity = row.get("order_position_forces", order)
    return str(order) if order == without_velocity else f"{order} ({without_velocity})"


def constant_text(row: Row) -> str:
    """Return the error constant as a rational, or as a decimal where it is none."""
    return row.get("error_constant_exact") or formatted(row["error_constant"], ".10g")


def milliseconds_text(row: Row) -> str:
    """Return median and range of the processor time of a run: 3.27 (3.24 to 3.41)."""
    return f"{1e3 * row['seconds']:.3g} ({1e3 * row['seconds_min']:.3g} to {1e3 * row['seconds_max']:.3g})"


def safe_step_text(row: Row) -> str:
    """Return the largest safe step (s) to four digits, rounded down so that it is safe; unlimited, or none."""
    limit = row["h_limit"]
    if not row["safe"]:
        return "none"
    if limit is None:
        return "unlimited"
    return f"{float(Context(prec=4, rounding=ROUND_FLOOR).create_decimal_from_float(limit)):.4g}"
