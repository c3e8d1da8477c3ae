"""Logs of other simulators: which integrator, with which feedback, made them?"""
