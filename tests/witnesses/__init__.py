"""Engines that are not ours, run: each must do what its row of the engine list, or a method's polynomial, says.

MuJoCo is run by tests/runs/test_mujoco_maps and test_mujoco_energy.
"""
