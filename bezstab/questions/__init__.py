"""Questions and their answers: the one door of the command line and of `import bezstab`.

    methods, a point or a goal, steps, an engine, a scene   →   Question   →   answers   →   row, table, text

`cli` and `api` make questions and hand on answers; neither computes.
"""

from typing import TYPE_CHECKING

from bezstab.lazy import lazy_names

if TYPE_CHECKING:
    from bezstab.questions.answering import Answer, CheckedRole, LargestStep, answers, engine_energy_rate
    from bezstab.questions.log_probes import PoleQuestion, Probe
    from bezstab.questions.motions import ReferenceMotion, check_speed, motion_of
    from bezstab.questions.question import Question, meant_in_seconds, methods_for, usual_goal
    from bezstab.questions.regions import MapAnswer, MapQuestion, RegionAnswer, region_answer
    from bezstab.questions.runs import RunQuestion, run_answer
    from bezstab.questions.trades import FrontQuestion, TradeQuestion
    from bezstab.questions.verifications import VerifyQuestion

__getattr__ = lazy_names(__name__)
