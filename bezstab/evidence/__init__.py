"""Whether the prediction holds: measured poles, outside witnesses, what accuracy costs."""

from bezstab.evidence.accuracy_costs import (
    FINE,
    METHODS,
    STEPS,
    Run,
    Sweep,
    map_cost,
    measured_runs,
    pareto_front,
    reference_motion,
    summary,
    swept_runs,
    words,
)
from bezstab.evidence.chunks import ATTEMPTS, Arrays, chunk_store, completed_chunks, worker_pool
from bezstab.evidence.extremes import Check, extreme_checks
from bezstab.evidence.linear_prediction import SPREAD, Fit, Refusal, fit_dominant_pole
from bezstab.evidence.measured_poles import CLOSE, LINEAR, Measurement, measure_poles, random_points
from bezstab.evidence.mujoco_witness import TIMES, model_xml, mujoco_witnesses, witness_count
from bezstab.evidence.verdict_maps import MapRows, VerdictMap, map_rows, simulated_verdicts, verdict_map

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
    "Refusal",
    "Run",
    "Sweep",
    "VerdictMap",
    "chunk_store",
    "completed_chunks",
    "extreme_checks",
    "fit_dominant_pole",
    "map_cost",
    "map_rows",
    "measure_poles",
    "measured_runs",
    "model_xml",
    "mujoco_witnesses",
    "pareto_front",
    "random_points",
    "reference_motion",
    "simulated_verdicts",
    "summary",
    "swept_runs",
    "verdict_map",
    "witness_count",
    "words",
    "worker_pool",
]
