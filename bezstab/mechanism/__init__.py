"""Planar mechanisms: scenes as data, their equations of motion, and runs with feedback.

    scene (TOML data) -> compiled_mechanism (equations of motion, sympy) -> initial_state -> simulate -> observe

Units are SI and rad.
"""

from bezstab.mechanism.compiled_stepping import runs_compiled
from bezstab.mechanism.constraint_normals import (
    ConstraintMotion,
    TurningNormals,
    along_normals,
    constraint_motion,
    turned_across,
    turning_normals,
)
from bezstab.mechanism.equations import Mechanism, T, compiled_mechanism
from bezstab.mechanism.generated_code import accelerations, lane_function, state_function
from bezstab.mechanism.motions import Motion, motion, motion_over, regular_motion
from bezstab.mechanism.observation import Observation, energy_balance, multiplier_work, observe, singular_passages
from bezstab.mechanism.programs import even_steps, program_of
from bezstab.mechanism.runner import Start, Trajectory, march, resume, simulate
from bezstab.mechanism.scene_files import load_scene, shipped_scenes
from bezstab.mechanism.scenes import DURATION, GROUND, Body, Driver, Force, Revolute, Scene, at_speed
from bezstab.mechanism.second_order_memory import Memory, memory
from bezstab.mechanism.simulation import Simulation, check_duration, simulated
from bezstab.mechanism.start import constraint_errors, constraint_jacobian, initial_state, perturbed_state
from bezstab.mechanism.stepper import Stepper, linearized_step
