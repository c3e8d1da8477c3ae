"""Engines that are not ours, run: each must do what its row of the engine list, or a method's polynomial, says.

MuJoCo has a witness of its own in the package (evidence/mujoco_witness) and in tests/evidence/test_mujoco_lint.
"""
