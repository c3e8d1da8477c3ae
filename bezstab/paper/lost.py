"""What cannot be tested: the scan lost it, the paper never said it, or bezstab does not have what it is about."""

from bezstab.paper.printed import NOT_HERE
from bezstab.paper.reports import Finding

LOST = (
    (
        "Table 6",
        "seconds of processor time",
        "8.34 to 8.63 s",
        "its machine and program are not here; Table 6 has ours beside them",
    ),
    ("Table 4", "the six parameters and their poles", "lost in the scan", "ours fit what the text says"),
    ("Figs 1 to 3, 5 to 9", "the curves themselves", "lost in the scan", "only sentences about them remain"),
    ("Section 5.2", "initial angle of the crank", "not stated", "45 degrees here"),
)
"""Where, the claim, what the paper says, and what is here instead."""

MISSING = [("Introduction", name, f"“{sentence}”", "not in bezstab: nothing to run") for name, sentence in NOT_HERE]

UNTESTED = [Finding(*claim, holds=[]) for claim in (*LOST, *MISSING)]
