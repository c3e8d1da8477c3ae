"""What the paper prints, as data to compare with."""

FASTER_LEVEL = {"B2": 0.65, "B3": 0.70, "B4": 0.75}
"""|z_p| below which Fig. 1 and section 5.1 call the region H."""

LEAST_Z_ABS = {"B2": 0.58, "B3": 0.62, "B4": 0.65}
"""The smallest |z_p| that section 5.1 found."""
