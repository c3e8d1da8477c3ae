"""Chains of bodies in engines that solve one constraint after another, in sweeps: are they stable, and what to set?"""
