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
    from bezstab.evidence.logs import Log, read_log
    from bezstab.evidence.measured_poles import (
        MeasuredVerdict,
        Measurement,
        measure_poles,
        measurement_summary,
        random_points,
    )
    from bezstab.evidence.parallel import Arrays, KeptResults, completed_chunks, joblib_is_installed
    from bezstab.evidence.probed_poles import (
        TURNED,
        Likeness,
        LikePoint,
        ProbedPole,
        kicked_responses,
        likenesses,
        point_like,
        probed_pole,
        told,
    )
    from bezstab.evidence.verdict_maps import VerdictMap, map_rows, simulated_verdicts, verdict_map

__getattr__ = lazy_names(__name__)
