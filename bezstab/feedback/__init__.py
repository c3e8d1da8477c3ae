"""Feedback: is yours safe (check), which to take (choose), and which poles does it make (poles)?"""
