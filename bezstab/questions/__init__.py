"""What somebody has, and what there is to answer: the one door of the command line and of `import bezstab`.

    methods, a point or a goal, steps, an engine or a drive, a scene   →   Question   →   answers   →   row, table, text

`cli` and `api` make questions and hand on answers; neither computes.
"""

from bezstab.questions.answering import SLOWER, Answer, Gains, LargestStep, answers, largest_step
from bezstab.questions.chains import Chain, ChainMap, Constraints, SweptAnswer, chain_map, typed_chain
from bezstab.questions.held_drives import HeldAnswer, HeldQuestion, UsedUp, held_answers, held_gains
from bezstab.questions.motions import ReferenceMotion, motion_of, turning_of, turning_stages, turns_too_far
from bezstab.questions.points import GivenPoint
from bezstab.questions.question import WHICH_METHOD, Question, StepRange, methods_for, usual_goal

__all__ = [
    "SLOWER",
    "WHICH_METHOD",
    "Answer",
    "Chain",
    "ChainMap",
    "Constraints",
    "Gains",
    "GivenPoint",
    "HeldAnswer",
    "HeldQuestion",
    "LargestStep",
    "Question",
    "ReferenceMotion",
    "StepRange",
    "SweptAnswer",
    "UsedUp",
    "answers",
    "chain_map",
    "held_answers",
    "held_gains",
    "largest_step",
    "methods_for",
    "motion_of",
    "turning_of",
    "turning_stages",
    "turns_too_far",
    "typed_chain",
    "usual_goal",
]
