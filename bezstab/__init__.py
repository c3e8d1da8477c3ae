"""Which Baumgarte parameters are safe, and best, for an explicit integrator at its step size.

Data flows one way: method -> derivation -> poles -> region -> figure.
"""

__version__ = "0.1.0"
