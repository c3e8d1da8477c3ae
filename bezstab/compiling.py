"""Whether functions run as machine code, by numba, an optional package: one choice for all runs."""

import importlib.util
import os
from typing import Any

from bezstab.errors import InputError

COMPILED_CHOICE = "BEZSTAB_COMPILED"
"""The environment variable that says whether runs are compiled: auto (also if it is not set), yes or no."""


def compiled_choice() -> str:
    """Return auto, yes or no; InputError for anything else."""
    choice = os.environ.get(COMPILED_CHOICE, "auto")
    if choice not in ("auto", "yes", "no"):
        raise InputError(f"{COMPILED_CHOICE}={choice}: expected auto, yes or no")
    return choice


def numba_is_installed() -> bool:
    """Return whether the compiler is there; it is not loaded."""
    return importlib.util.find_spec("numba") is not None


def compiler() -> Any:
    """Return numba. InputError without it."""
    try:
        import numba
    except ImportError:
        raise InputError("compiled runs need an optional package: pip install 'bezstab[fast]'") from None
    return numba
