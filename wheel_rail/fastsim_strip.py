"""One strip of FASTSIM: a particle's way from the leading to the trailing edge.

Of second order in the cells that stick or slide throughout; where one gives way to the other, a cell takes the growth
of its middle.
A strip is 2 long (u from 1 to -1) and its bound is 1 - u^2; stresses are in units of the bound at its middle.
"""

import math

from wheel_rail.compiled import inlined

THROUGH_ZERO = 0.01  # how readily stress that is pulled straight backwards in sliding falls through zero: any will do


@inlined
def strip_force(
    nx: int, grow_x: float, grow_y: float, grow_s: float, rate_x: float, rate_y: float, rate_s: float
) -> tuple[float, float, float, float]:
    """Stress over one strip, summed in cells, and its derivative along the slip.

    Growth over a cell is (`grow_x`, `grow_y` + `grow_s` u), its derivative that of the `rate`s, the bound 1 - u^2.
    Exact in adhesion. In sliding the direction n turns towards the growth g: B dn/du = g - (g n) n, so that for
    constant g and B the tangent of half the angle between them falls by exp(-g/B) over a cell.
    """
    du = 2.0 / nx
    curved, rate_curved = grow_s * du / 12.0, rate_s * du / 12.0  # what the trapezium leaves out
    sum_x = sum_y = sum_rate_x = sum_rate_y = 0.0
    px = py = qx = qy = 0.0  # stress and its derivative
    u, bound, i = 1.0, 0.0, 0
    while i < nx:
        # adhesion, cell by cell
        while i < nx:
            middle = u - 0.5 * du
            next_u = 1.0 - (i + 1) * du
            next_bound = max(1.0 - next_u * next_u, 0.0)
            straight = grow_y + grow_s * middle
            next_x, next_y = px + grow_x, py + straight
            size2 = next_x * next_x + next_y * next_y
            if size2 > next_bound * next_bound:
                break
            next_qx, next_qy = qx + rate_x, qy + rate_y + rate_s * middle
            sum_x += 0.5 * (px + next_x)
            sum_y += 0.5 * (py + next_y) + curved
            sum_rate_x += 0.5 * (qx + next_qx)
            sum_rate_y += 0.5 * (qy + next_qy) + rate_curved
            px, py, qx, qy = next_x, next_y, next_qx, next_qy
            u, bound = next_u, next_bound
            i += 1
        if i == nx:
            break
        # share of the cell in adhesion: where |p| - bound, which is convex for p on a straight way, rises through zero;
        # first by its value and slope at the start and its value at the end
        size, before, fall = math.sqrt(size2), math.sqrt(px * px + py * py), 2.0 * u * du
        start, beyond = min(before - bound, 0.0), size - next_bound
        slope = (px * grow_x + py * straight) / before - fall if before > 0.0 else size - fall
        stick, end_x, end_y = 0.0, px, py
        if slope < 0.0 or start < 0.0:
            bend = beyond - start - slope
            root = math.sqrt(max(slope * slope - 4.0 * bend * start, 0.0))
            stick = min(0.5 * (root - slope) / bend if slope < 0.0 else -2.0 * start / (slope + root), 1.0)
            low, high = 0.0, 1.0
            for _ in range(8):
                end_x, end_y = px + stick * grow_x, py + stick * straight
                size = math.sqrt(end_x * end_x + end_y * end_y)
                miss = size - bound - stick * (fall - stick * du * du)
                if abs(miss) < 1e-6:
                    break
                if miss > 0.0:
                    high, beyond = stick, miss
                    slope = (end_x * grow_x + end_y * straight) / size
                    stick -= miss / (slope - fall + 2.0 * stick * du * du)
                else:
                    low = stick
                    stick -= (high - stick) * miss / (beyond - miss)
                if not low < stick < high:
                    stick = 0.5 * (low + high)
        end_qx, end_qy = qx + stick * rate_x, qy + stick * (rate_y + rate_s * middle)
        cube = stick * stick * stick
        sum_x += 0.5 * stick * (px + end_x)
        sum_y += 0.5 * stick * (py + end_y) + curved * cube
        sum_rate_x += 0.5 * stick * (qx + end_qx)
        sum_rate_y += 0.5 * stick * (qy + end_qy) + rate_curved * cube
        size2 = end_x * end_x + end_y * end_y
        if size2 == 0.0:  # at the leading edge, along the growth
            end_x, end_y, end_qx, end_qy = grow_x, grow_y + grow_s * u, rate_x, rate_y + rate_s * u
            size2 = end_x * end_x + end_y * end_y
        # sliding: direction of the stress, and the derivative of its angle
        inverse = 1.0 / math.sqrt(size2)
        out_x, out_y = end_x * inverse, end_y * inverse
        turns = (out_x * end_qy - out_y * end_qx) * inverse
        rest = 1.0 - stick
        bound += stick * du * (2.0 * u - stick * du)
        u -= stick * du
        while True:
            way = rest * du
            mean = bound + way * (u - way / 3.0)
            late = 0.5 * bound + way * (2.0 / 3.0 * u - 0.25 * way)  # weighted by the share of the way
            # the direction lags behind the growth: what it meets at the end is the growth of a moment before; a rough
            # size of the growth will do
            one, other = abs(grow_x), abs(grow_y + grow_s * (u - 0.5 * way))
            rough = rest * (max(one, other) + 0.4 * min(one, other))
            met = next_u + 0.5 * way * (next_bound + mean) / (next_bound + mean + rough)
            aim_y, aim_rate = grow_y + grow_s * met, rate_y + rate_s * met
            aim = math.sqrt(grow_x * grow_x + aim_y * aim_y)
            # exp(-z) = kept/gone = 1/(1 + z + z^2/2), z = turn/mean
            turn, kept = rest * aim, mean * mean
            gone = kept + turn * (mean + 0.5 * turn)
            end_x, end_y, end_turns = out_x, out_y, turns
            if aim > 0.0:
                per_aim = 1.0 / aim
                aim_x, aim_y = grow_x * per_aim, aim_y * per_aim
                aim_turns = (aim_x * aim_rate - aim_y * rate_x) * per_aim
                dot, cross = out_x * aim_x + out_y * aim_y, aim_x * out_y - aim_y * out_x
                far, twice = kept * kept * (1.0 - dot), 2.0 * kept * gone
                if dot > 0.0:
                    near = gone * gone * (1.0 + dot)
                else:
                    # 1 + dot unrounded; stress against the growth falls through zero rather than wait for a turn
                    near = gone * gone * cross * cross / (1.0 - dot) + THROUGH_ZERO * ((gone - kept) * dot) ** 2
                inverse = 1.0 / (near + far)
                along, across = (near - far) * inverse, twice * cross * inverse
                end_x, end_y = along * aim_x - across * aim_y, along * aim_y + across * aim_x
                end_turns = aim_turns + twice * inverse * (turns - aim_turns)
            early = rest * (mean - late)
            late *= rest
            sum_x += early * out_x + late * end_x
            sum_y += early * out_y + late * end_y
            sum_rate_x -= early * out_y * turns + late * end_y * end_turns
            sum_rate_y += early * out_x * turns + late * end_x * end_turns
            out_x, out_y, turns = end_x, end_y, end_turns
            u, bound = next_u, next_bound
            i += 1
            if i == nx or grow_x * out_x + (grow_y + grow_s * (u - 0.5 * du)) * out_y < 2.0 * u * du:
                break
            rest = 1.0
            next_u = 1.0 - (i + 1) * du
            next_bound = max(1.0 - next_u * next_u, 0.0)
        px, py = bound * out_x, bound * out_y
        qx, qy = -py * turns, px * turns
    return sum_x, sum_y, sum_rate_x, sum_rate_y
