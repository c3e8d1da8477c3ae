"""What cannot be tested, because the scan lost it or the paper never said it."""

from bezstab.paper.findings import Finding, finding


def findings() -> list[Finding]:
    """Return what cannot be tested, and why."""
    return [
        finding(
            where="Table 6",
            claim="seconds of processor time",
            paper="8.34 to 8.63 s",
            here="machine and program are not known",
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
    ]
