"""Where a command or an option went that is no more: each answers in one line."""

from collections.abc import Mapping

WENT: Mapping[str, str] = {
    "explore": "see `region --figure window`",
    "verify --accuracy": "see `methods NAME` and `choose` with --omega: what they predict is held by a test",
    "verify --witness": "a test runs MuJoCo, and it diverges where the map says: tests/runs/test_mujoco_maps.py",
    "probe --time": "name the column of times t or time",
    "probe --jointly": "each column has its own pole",
    "check --pd": "see `bezstab drive`",
    "choose --pd": "see `bezstab drive`",
    "choose --bandwidth": "see `bezstab drive`",
    "region --pd": "see `bezstab drive --figure png`",
    "poles --pd": "see `bezstab drive`",
    "poles --omega": "see `bezstab check --omega`, which tells the errors on a motion",
    **dict.fromkeys(
        (f"{command} {option}" for command in ("check", "choose") for option in ("--h-min", "--hold")),
        "see `bezstab steps`",
    ),
    "check --h-max": "see `bezstab steps`",
    "schema": "a table says what each key means, and its unit: bezstab/show/keys.csv",
    "chains": "see `bezstab chain --figure png`",
    "check --chain": "see `bezstab chain`",
    "choose --chain": "see `bezstab chain`",
    "family": "see `region --compare` for the regions, and `methods NAME` for order and error constant",
    "extremes": "see `make extremes`, which writes figures/extremes.md, and the slow tests",
    "paper --format": "what came of the paper's claims stands in figures/LEDGER.md",
}
"""Of commands ("family") and options ("verify --witness") that were removed: what gives their answer now."""


def where_it_went(name: str) -> str | None:
    """Return the line for a command or an option; None if none of that name was removed."""
    return f"`{name}`: {WENT[name]}" if name in WENT else None
