"""Whether the prediction holds: measured poles, outside witnesses, what accuracy costs.

The only room in which stability and mechanism meet. A file imports only from those above it:

    worker_pools        who does long work: processes, or a cluster's workers
    chunk_stores        where finished chunks are kept, under a lock
    chunks              long work in chunks, spread over workers, kept as they arrive
    linear_prediction   the dominant pole in a sampled response, or why none can be told
    noisy_prediction    the same beside white noise, and that there is nothing but noise
    mixing_poles        two poles near each other, and how far a motion takes them
    moving_mechanisms   what a mechanism's motion does to its poles, to first order
    moving_regions      the region of a mechanism that moves
    linearized_steps    a method's steps along a motion, linearised
    floquet             the exact rates of a mechanism that moves
    own_motions         the same along the motion that the method itself makes
    kicked_revolutions  the rate of runs that are kicked from that motion
    measured_poles      predicted against measured poles of a running mechanism
    logs                logs of somebody else's simulator, as columns of numbers
    probed_poles        the dominant pole in a log, and whose it is
    kick_fates          whether the constraint error that a kick has made grows or dies
    verdict_maps        simulated verdicts over the plane against |z_p| < 1
    mujoco_models       a MuJoCo model's step, constraints, springs, drives and masses
    mujoco_controllers  what closes the loop of its motors from outside, every few steps and late
    mujoco_lint         what they mean in alpha_hat and beta_hat, and whether they are safe
    mujoco_witness      an engine that is not ours must diverge where the map says
    reference_motions   a motion known to some thirteen digits
    forced_runs         the constraint error that a method forces on a mechanism, predicted and measured
    pareto              which runs no other beats
    accuracy_costs      what a method and a step cost in simulation, and what they buy
    recorded_times      processor times that an earlier sweep measured
    sweep_summaries     that in sentences
    root_digits         how many digits of a pole are right, against a hundred
    extremes            what holds where numbers are extreme
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
    kicked_constraint_errors,
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
    "kicked_constraint_errors",
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
