"""Results as rows and tables, and as figures; `plot` is the public module that draws on a user's own Axes.

What draws is not loaded before it is used.
"""
