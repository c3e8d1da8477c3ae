"""Planar mechanisms: scenes as data, their equations of motion, and runs with feedback.

    scene (TOML data) -> equations_of_motion (sympy) -> compiled_mechanism -> initial_state -> simulate -> observe

From data upwards; a file imports only from those above it:

    scenes              bodies, joints, forces, springs and initial state as checked data
    scene_files         their file format
    equations           M, c, C_q, gamma and g by sympy
    second_order_memory what a second-order scheme carries from step to step, and when it evaluates
    second_order_turns  a step of a second-order scheme, and of all that are implicit, as a list of actions
    generated_code      the one place that writes and compiles Python source: accelerations, steppers
    newton_iterations   Newton's method for the accelerations of an implicit step
    newton_side_by_side the same of many runs at a time, as machine code takes it
    compiled            a scene with its compiled functions, made once
    compiled_steps      steps as machine code, by numba, the same to the last bit
    compiled_batches    the same of many runs at a time, of which only constraint errors matter
    observation         what the constraints do along a history
    energies            work of drivers and forces, and the drift that is left
    start               consistent initial states, and perturbed ones
    runner              runs of a method with feedback, and what ends one early
    motions             the motion itself, as a function of time, and when it begins anew
    linearized          how the acceleration changes with position and velocity
    constraint_normals  how fast the directions of the constraints turn along a motion
    constraint_motions  how a motion drives the constraints: its rate and amplitude
    simulation          a run and its observation as one value
    varying_runs        the same with steps that vary
"""

from bezstab.mechanism.compiled import (
    SINGULAR,
    Mechanism,
    acceleration_function,
    compiled_mechanism,
    multipliers_function,
    stepper_code,
)
from bezstab.mechanism.compiled_steps import (
    CHEAPER_TOGETHER,
    runs_compiled,
)
from bezstab.mechanism.constraint_motions import ConstraintMotion, along_normals, constraint_motion
from bezstab.mechanism.constraint_normals import TurningNormals, turned_across, turning_normals
from bezstab.mechanism.energies import EnergyBalance, energy_balance
from bezstab.mechanism.equations import Equations, T, equations_of_motion
from bezstab.mechanism.generated_code import compiled_source
from bezstab.mechanism.linearized import linearized_acceleration
from bezstab.mechanism.motions import Motion, motion, regular_motion, revolution_period
from bezstab.mechanism.observation import Observation, observe, singular_passages
from bezstab.mechanism.runner import (
    Start,
    Trajectory,
    march,
    march_in_blocks,
    resume,
    resume_in_groups,
    simulate,
    states_needed,
)
from bezstab.mechanism.scene_files import load_scene, parse_scene, read_scene, shipped_scenes
from bezstab.mechanism.scenes import (
    COORDINATES,
    GROUND,
    Body,
    Distance,
    Driver,
    Force,
    Joint,
    PointOnLine,
    Revolute,
    Scene,
    Spring,
    at_speed,
)
from bezstab.mechanism.second_order_memory import Memory, memory
from bezstab.mechanism.second_order_turns import Assigned, Evaluated, Solved, turn
from bezstab.mechanism.simulation import MOST_STEPS, Simulation, simulated
from bezstab.mechanism.start import constraint_errors, constraint_jacobian, initial_state, perturbed_state
from bezstab.mechanism.varying_runs import simulated_with_steps

__all__ = [
    "CHEAPER_TOGETHER",
    "COORDINATES",
    "GROUND",
    "MOST_STEPS",
    "SINGULAR",
    "Assigned",
    "Body",
    "ConstraintMotion",
    "Distance",
    "Driver",
    "EnergyBalance",
    "Equations",
    "Evaluated",
    "Force",
    "Joint",
    "Mechanism",
    "Memory",
    "Motion",
    "Observation",
    "PointOnLine",
    "Revolute",
    "Scene",
    "Simulation",
    "Solved",
    "Spring",
    "Start",
    "T",
    "Trajectory",
    "TurningNormals",
    "acceleration_function",
    "along_normals",
    "at_speed",
    "compiled_mechanism",
    "compiled_source",
    "constraint_errors",
    "constraint_jacobian",
    "constraint_motion",
    "energy_balance",
    "equations_of_motion",
    "initial_state",
    "linearized_acceleration",
    "load_scene",
    "march",
    "march_in_blocks",
    "memory",
    "motion",
    "multipliers_function",
    "observe",
    "parse_scene",
    "perturbed_state",
    "read_scene",
    "regular_motion",
    "resume",
    "resume_in_groups",
    "revolution_period",
    "runs_compiled",
    "shipped_scenes",
    "simulate",
    "simulated",
    "simulated_with_steps",
    "singular_passages",
    "states_needed",
    "stepper_code",
    "turn",
    "turned_across",
    "turning_normals",
]
