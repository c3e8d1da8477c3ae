"""Integration methods as exact data, and what follows from their coefficients.

What needs sympy is loaded when first used: naming a multistep or Runge-Kutta method does not.
"""
