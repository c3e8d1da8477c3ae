"""Whether the prediction holds: measured poles, outside witnesses, what accuracy costs.

The only room in which stability and mechanism meet.
"""

from bezstab.evidence.accuracy_costs import (
    METHODS,
    STEPS,
    Cost,
    Run,
    Sweep,
    SweptRuns,
    measured_runs,
    sweep_compiled,
    swept_runs,
    with_fronts,
)
from bezstab.evidence.chunk_stores import Arrays, chunk_store
from bezstab.evidence.chunks import ATTEMPTS, completed_chunks
from bezstab.evidence.extremes import Check, extreme_checks
from bezstab.evidence.floquet import floquet_rates
from bezstab.evidence.forced_runs import HOLDS, SHARES, ForcedMotion, HalvedStep, forced_motions, halved_steps
from bezstab.evidence.linear_prediction import SPREAD, Fit, Refusal, fit_dominant_pole
from bezstab.evidence.logs import Log, error_columns, log_from, parse_log, read_log, row_step, time_column
from bezstab.evidence.measured_poles import (
    CLOSE,
    LINEAR,
    Measurement,
    kicked_motions,
    measure_poles,
    random_points,
)
from bezstab.evidence.moving_mechanisms import (
    LAW_HOLDS,
    MovingPole,
    MovingVerdict,
    growth_rates,
    momentary_rates,
    moving_pole,
    moving_poles,
    tabulated_rates,
)
from bezstab.evidence.moving_regions import MovingRegion, moving_growth, moving_modulus, moving_region
from bezstab.evidence.mujoco_controllers import MotorGains
from bezstab.evidence.mujoco_lint import Linted, linted_model
from bezstab.evidence.mujoco_models import ModelData, model_data, mujoco_module, read_mujoco_model
from bezstab.evidence.mujoco_witness import TIMES, Witnessed, model_xml, mujoco_witnesses, witness_count
from bezstab.evidence.own_motions import own_motion_rates
from bezstab.evidence.pareto import pareto_front
from bezstab.evidence.probed_poles import (
    Likeness,
    LikePoint,
    Probe,
    ProbedPole,
    kicked_responses,
    likenesses,
    points_like,
    probed_pole,
    steps_between_rows,
)
from bezstab.evidence.recorded_times import read_times, with_recorded_times
from bezstab.evidence.reference_motions import ReferenceMotion, reference_motion
from bezstab.evidence.sweep_summaries import Held, Summary, summary, sweep_sentences
from bezstab.evidence.verdict_maps import MapRows, VerdictMap, map_rows, simulated_verdicts, verdict_map
from bezstab.evidence.worker_pools import worker_pool

__all__ = [
    "ATTEMPTS",
    "CLOSE",
    "HOLDS",
    "LAW_HOLDS",
    "LINEAR",
    "METHODS",
    "SHARES",
    "SPREAD",
    "STEPS",
    "TIMES",
    "Arrays",
    "Check",
    "Cost",
    "Fit",
    "ForcedMotion",
    "HalvedStep",
    "Held",
    "LikePoint",
    "Likeness",
    "Linted",
    "Log",
    "MapRows",
    "Measurement",
    "ModelData",
    "MotorGains",
    "MovingPole",
    "MovingRegion",
    "MovingVerdict",
    "Probe",
    "ProbedPole",
    "ReferenceMotion",
    "Refusal",
    "Run",
    "Summary",
    "Sweep",
    "SweptRuns",
    "VerdictMap",
    "Witnessed",
    "chunk_store",
    "completed_chunks",
    "error_columns",
    "extreme_checks",
    "fit_dominant_pole",
    "floquet_rates",
    "forced_motions",
    "growth_rates",
    "halved_steps",
    "kicked_motions",
    "kicked_responses",
    "likenesses",
    "linted_model",
    "log_from",
    "map_rows",
    "measure_poles",
    "measured_runs",
    "model_data",
    "model_xml",
    "momentary_rates",
    "moving_growth",
    "moving_modulus",
    "moving_pole",
    "moving_poles",
    "moving_region",
    "mujoco_module",
    "mujoco_witnesses",
    "own_motion_rates",
    "pareto_front",
    "parse_log",
    "points_like",
    "probed_pole",
    "random_points",
    "read_log",
    "read_mujoco_model",
    "read_times",
    "reference_motion",
    "row_step",
    "simulated_verdicts",
    "steps_between_rows",
    "summary",
    "sweep_compiled",
    "sweep_sentences",
    "swept_runs",
    "tabulated_rates",
    "time_column",
    "verdict_map",
    "with_fronts",
    "with_recorded_times",
    "witness_count",
    "worker_pool",
]
