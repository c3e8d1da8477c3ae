"""How much the slow tests of this room take."""

import os
from typing import TypeVar

Sample = TypeVar("Sample")


def of_campaign(whole: Sample, part: Sample) -> Sample:
    """Return the whole of a sample where a campaign is run, by BEZSTAB_CAMPAIGN=yes, else a part of it."""
    return whole if os.environ.get("BEZSTAB_CAMPAIGN") == "yes" else part
