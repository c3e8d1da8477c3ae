"""What cannot be tested: the scan lost it, the paper never said it, or bezstab does not have what it is about."""

from bezstab.paper.findings import Finding, finding
from bezstab.paper.printed import NOT_HERE


def findings() -> list[Finding]:
    """Return what cannot be tested, and why."""
    return [
        finding(
            where="Table 6",
            claim="seconds of processor time",
            paper="8.34 to 8.63 s",
            here="its machine and program are not here; Table 6 has ours beside them",
            holds=[],
        ),
        finding(
            where="Table 4",
            claim="the six parameters and their poles",
            paper="lost in the scan",
            here="ours fit what the text says",
            holds=[],
        ),
        finding(
            where="Figs 1 to 3, 5 to 9",
            claim="the curves themselves",
            paper="lost in the scan",
            here="only sentences about them remain",
            holds=[],
        ),
        finding(
            where="Section 5.2",
            claim="initial angle of the crank",
            paper="not stated",
            here="45 degrees here",
            holds=[],
        ),
        *(
            finding(
                where="Introduction", claim=name, paper=f"“{sentence}”", here="not in bezstab: nothing to run", holds=[]
            )
            for name, sentence in NOT_HERE
        ),
    ]
