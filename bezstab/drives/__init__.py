"""Joint drives: is torque = -kp (q - target) - kd q' on an inertia safe, fresh, held or late, and what may change?"""
