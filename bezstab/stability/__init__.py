"""Poles of the closed loop, the exact region, its best point, and which parameters to choose.

What needs sympy's polynomials is loaded when first used: poles and maps do not.
"""
