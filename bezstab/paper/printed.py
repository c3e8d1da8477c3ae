"""What the paper prints, as data to compare with. (Its Tables 1, 2 and 4 and its figures are lost in the scan.)"""

FASTER_LEVEL = {"B2": 0.65, "B3": 0.70, "B4": 0.75}
"""|z_p| below which Fig. 1 and section 5.1 call the region H."""

COMPARED = ("B4", "AB4", "RK4@5", "SIE")
"""The methods of Tables 5 and 6, all with steps of 1 ms but RK4, with 5 ms; SIE is "Euler semi-implicit"."""

TABLE_5 = {
    ("0.1", "0.1"): {
        "B4": "0.898 0.299 0.947 18.45",
        "AB4": "0.906 0.291 0.952 17.83",
        "RK4@5": "0.074 0.740 0.744 84.27",
        "SIE": "0.855 0.281 0.9 18.19",
    },
    ("0.5", "0.1"): {
        "B4": "0.763 0.142 0.776 10.55",
        "AB4": "-0.903 0.428 0.999 154.6",
        "RK4@5": "0.095 0.237 0.255 68.15",
        "SIE": "0.775 0.097 0.781 7.12",
    },
    ("0.5", "0.101"): {
        "B4": "0.762 0.144 0.776 10.69",
        "AB4": "-0.903 0.433 1.001 154.4",
        "RK4@5": "0.090 0.241 0.258 69.45",
        "SIE": "0.774 0.098 0.780 7.22",
    },
}
"""By α̂, β̂ and method: Re z, Im z, |z| and ∠z (degrees) of the dominant pole. Its digits are part of what it says."""

TABLE_6 = {"B4": "8.34, 8.42, 8.39", "AB4": "8.41, 8.38, 8.42", "RK4@5": "8.63, 8.55, 8.60", "SIE": "8.52, 8.56, 8.53"}
"""Processor times (s) of the three cases of Table 5, by method."""
