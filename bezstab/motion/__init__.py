"""What the feedback does to the motion itself: the third map."""

from bezstab.motion.modulated_circle import MotionEnergy, motion_energy, steps_to_breakdown
from bezstab.motion.spinning_bodies import spin_change
