"""Planar mechanisms: scenes as data, their equations of motion, and runs with feedback."""

from bezstab.mechanism.equations import (
    Mechanism,
    Observation,
    T,
    compiled_mechanism,
    compiled_source,
    constraint_errors,
    equations_of_motion,
    initial_state,
    observe,
    perturbed_state,
)
from bezstab.mechanism.runner import Start, Trajectory, march, resume, simulate, stepper_code
from bezstab.mechanism.scene_files import load_scene, parse_scene, read_scene, shipped_scenes
from bezstab.mechanism.scenes import COORDINATES, GROUND, Body, Force, Revolute, Scene

__all__ = [
    "COORDINATES",
    "GROUND",
    "Body",
    "Force",
    "Mechanism",
    "Observation",
    "Revolute",
    "Scene",
    "Start",
    "T",
    "Trajectory",
    "compiled_mechanism",
    "compiled_source",
    "constraint_errors",
    "equations_of_motion",
    "initial_state",
    "load_scene",
    "march",
    "observe",
    "parse_scene",
    "perturbed_state",
    "read_scene",
    "resume",
    "shipped_scenes",
    "simulate",
    "stepper_code",
]
