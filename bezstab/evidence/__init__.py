"""Whether the prediction holds: measured poles, predicted errors, what accuracy costs.

The only room in which stability and mechanism meet.
"""

from typing import TYPE_CHECKING

from bezstab.lazy import lazy_names

if TYPE_CHECKING:
    from bezstab.evidence.accuracy_costs import (
        METHODS,
        NO_FEEDBACK,
        STEPS,
        Cost,
        ErrorOf,
        ReferenceRun,
        Run,
        Sweep,
        SweptRuns,
        measured_runs,
        reference_run,
        swept_runs,
    )
    from bezstab.evidence.logs import (
        UNEVEN,
        Log,
        error_columns,
        log_from,
        looks_absolute,
        read_log,
        row_step,
        time_column,
    )
    from bezstab.evidence.measured_poles import (
        MeasuredVerdict,
        Measurement,
        measure_poles,
        measurement_summary,
        random_points,
    )
    from bezstab.evidence.parallel import Arrays, KeptResults, completed_chunks, joblib_is_installed
    from bezstab.evidence.probed_poles import (
        Likeness,
        LikePoint,
        ProbedPole,
        kicked_responses,
        likenesses,
        points_like,
        probed_pole,
    )
    from bezstab.evidence.verdict_maps import VerdictMap, map_rows, simulated_verdicts, verdict_map

__getattr__ = lazy_names(__name__)
