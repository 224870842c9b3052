"""Spans of a recorded stop in which something holds: found, merged, measured."""

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]


def spans(holds: Mask) -> NDArray[np.intp]:
    """Rows (k, 2) of each span in which `holds` (n,): its first row and the first one after it."""
    edges = np.flatnonzero(np.diff(np.concatenate([[False], holds, [False]]).astype(np.int8)))
    return edges.reshape(-1, 2)


def durations_s(t_s: Array, holds: Mask) -> Array:
    """Duration of each span: what a row says holds until the next row; the last row of a record lasts no time."""
    begins, ends = spans(holds).T
    return np.asarray(t_s[np.minimum(ends, len(t_s) - 1)] - t_s[begins])


def longest_s(t_s: Array, holds: Mask) -> float:
    """Duration of the longest span, 0 without any."""
    return float(durations_s(t_s, holds).max(initial=0.0))


def merged_spans_s(t_s: Array, holds: Mask, gap_s: float) -> list[tuple[float, float]]:
    """Begin and end in s of the spans in which `holds`, those not more than `gap_s` apart taken as one."""
    found: list[tuple[float, float]] = []
    for begin, end in spans(holds):
        begin_s, end_s = float(t_s[begin]), float(t_s[min(end, len(t_s) - 1)])
        if found and begin_s - found[-1][1] <= gap_s + 1e-9:
            found[-1] = (found[-1][0], end_s)
        else:
            found.append((begin_s, end_s))
    return found
