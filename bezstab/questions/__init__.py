"""Questions and their answers: the one door of the command line and of `import bezstab`.

    methods, a point or a goal, steps, an engine, a scene   →   Question   →   answers   →   row, table, text

`cli` and `api` make questions and hand on answers; neither computes.
"""
