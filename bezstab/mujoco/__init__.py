"""MuJoCo is asked: is a model safe at its time step, where, and what makes it unsafe?"""
