"""Whether the prediction holds: measured poles, outside witnesses, what accuracy costs.

The only room in which stability and mechanism meet. A file imports only from those above it:

    worker_pools        who does long work: processes, or a cluster's workers
    chunk_stores        where finished chunks are kept, under a lock
    chunks              long work in chunks, spread over workers, kept as they arrive
    linear_prediction   the dominant pole in a sampled response, or why none can be told
    moving_mechanisms   what a mechanism's motion does to its poles, to first order
    moving_regions      the region of a mechanism that moves
    floquet             the exact rates of a mechanism that moves
    measured_poles      predicted against measured poles of a running mechanism
    verdict_maps        simulated verdicts over the plane against |z_p| < 1
    mujoco_witness      an engine that is not ours must diverge where the map says
    reference_motions   a motion known to some thirteen digits
    pareto              which runs no other beats
    accuracy_costs      what a method and a step cost in simulation, and what they buy
    sweep_summaries     that in sentences
    root_digits         how many digits of a pole are right, against a hundred
    extremes            what holds where numbers are extreme
"""

from bezstab.evidence.accuracy_costs import (
    METHODS,
    STEPS,
    Run,
    Sweep,
    SweptRuns,
    measured_runs,
    sweep_compiled,
    swept_runs,
    whole_sweep,
    with_fronts,
)
from bezstab.evidence.chunk_stores import Arrays, chunk_store
from bezstab.evidence.chunks import ATTEMPTS, completed_chunks
from bezstab.evidence.extremes import Check, extreme_checks
from bezstab.evidence.floquet import floquet_rates
from bezstab.evidence.linear_prediction import SPREAD, Fit, Refusal, fit_dominant_pole
from bezstab.evidence.measured_poles import (
    CLOSE,
    LINEAR,
    Measurement,
    kicked_constraint_errors,
    measure_poles,
    random_points,
)
from bezstab.evidence.moving_mechanisms import (
    MovingPole,
    MovingVerdict,
    growth_rates,
    momentary_rates,
    moving_pole,
    moving_poles,
    tabulated_rates,
)
from bezstab.evidence.moving_regions import MovingRegion, moving_growth, moving_modulus, moving_region
from bezstab.evidence.mujoco_witness import TIMES, model_xml, mujoco_witnesses, witness_count
from bezstab.evidence.pareto import pareto_front
from bezstab.evidence.reference_motions import ReferenceMotion, reference_motion
from bezstab.evidence.sweep_summaries import FINE, Summary, summary, sweep_sentences
from bezstab.evidence.verdict_maps import MapRows, VerdictMap, map_rows, simulated_verdicts, verdict_map
from bezstab.evidence.worker_pools import worker_pool

__all__ = [
    "ATTEMPTS",
    "CLOSE",
    "FINE",
    "LINEAR",
    "METHODS",
    "SPREAD",
    "STEPS",
    "TIMES",
    "Arrays",
    "Check",
    "Fit",
    "MapRows",
    "Measurement",
    "MovingPole",
    "MovingRegion",
    "MovingVerdict",
    "ReferenceMotion",
    "Refusal",
    "Run",
    "Summary",
    "Sweep",
    "SweptRuns",
    "VerdictMap",
    "chunk_store",
    "completed_chunks",
    "extreme_checks",
    "fit_dominant_pole",
    "floquet_rates",
    "growth_rates",
    "kicked_constraint_errors",
    "map_rows",
    "measure_poles",
    "measured_runs",
    "model_xml",
    "momentary_rates",
    "moving_growth",
    "moving_modulus",
    "moving_pole",
    "moving_poles",
    "moving_region",
    "mujoco_witnesses",
    "pareto_front",
    "random_points",
    "reference_motion",
    "simulated_verdicts",
    "summary",
    "sweep_compiled",
    "sweep_sentences",
    "swept_runs",
    "tabulated_rates",
    "verdict_map",
    "whole_sweep",
    "with_fronts",
    "witness_count",
    "worker_pool",
]
