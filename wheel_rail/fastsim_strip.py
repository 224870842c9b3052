"""One strip of FASTSIM: a particle's way from the leading to the trailing edge.

Of second order in the cells that stick or slide throughout; where one gives way to the other, a cell takes the growth
of its middle. That place is found to a share of a cell, and as it moves with the growth its part is in the derivative:
on a coarse grid the two sides of it do not fit together to the last, which leaves ripples on the force.
A strip is 2 long (u from 1 to -1) and its bound is 1 - u^2; stresses are in units of the bound at its middle.
"""

import math

from wheel_rail.compiled import inlined

_THIRD = 1.0 / 3.0
THROUGH_ZERO = 0.01  # how readily stress that is pulled straight backwards in sliding falls through zero: any will do


@inlined
def _rough_size(x: float, y: float) -> float:
    one, other = abs(x), abs(y)
    return max(one, other) + 0.4 * min(one, other)


@inlined
def _turned(
    out_x: float, out_y: float, turns: float, aim_x: float, aim_y: float, rate_x: float, rate_y: float, aim2: float,
    rest: float, mean: float, less: float,
) -> tuple[float, float, float]:  # fmt: skip
    """Direction (`out_x`, `out_y`) of the stress at the end of the share `rest` of a cell, and the derivative of its
    angle, `turns` at the start.

    `aim`: growth over a whole cell, not zero, of size squared `aim2`; (`rate_x`, `rate_y`) its derivative; `mean`: the
    bound. The angle to the aim shrinks by z = rest |aim|/mean; `less`: what the derivative of rest/mean takes from that
    of z, times -mean |aim|.
    """
    aim = math.sqrt(aim2)
    # exp(-z) = kept/gone = 1/(1 + z + z^2/2), z = turn/mean
    turn, kept = rest * aim, mean * mean
    gone = kept + turn * (mean + 0.5 * turn)
    dot, cross = out_x * aim_x + out_y * aim_y, aim_x * out_y - aim_y * out_x
    far, twice = kept * kept * (aim - dot), 2.0 * kept * gone
    if dot > 0.0:
        near = gone * gone * (aim + dot)
    else:
        # aim + dot unrounded; stress against the growth falls through zero rather than wait for a turn
        near = gone * gone * cross * cross / (aim - dot) + THROUGH_ZERO * ((gone - kept) * dot) ** 2 / aim
    inverse = 1.0 / ((near + far) * aim)
    along, across = (near - far) * inverse, twice * cross * inverse
    per = 1.0 / (aim2 * gone)
    aim_turns = (aim_x * rate_y - aim_y * rate_x) * (per * gone)
    grows = rest * (aim_x * rate_x + aim_y * rate_y) - less
    end_turns = (
        aim_turns + twice * aim2 * inverse * (turns - aim_turns) - across * grows * ((mean + turn) * (per * aim2))
    )
    return along * aim_x - across * aim_y, along * aim_y + across * aim_x, end_turns


@inlined
def strip_force(
    nx: int, grow_x: float, grow_y: float, grow_s: float, rate_x: float, rate_y: float, rate_s: float, along_x: float,
    along_y: float,
) -> tuple[float, float, float]:  # fmt: skip
    """Stress over one strip, summed in cells, and its derivative along the slip, the part that points along
    (`along_x`, `along_y`).

    Growth over a cell is (`grow_x`, `grow_y` + `grow_s` u), its derivative that of the `rate`s, the bound 1 - u^2.
    Exact in adhesion. In sliding the direction n turns towards the growth g: B dn/du = g - (g n) n, so that for
    constant g and B the tangent of half the angle between them falls by exp(-g/B) over a cell.
    """
    du = 2.0 / nx
    curved, rate_curved = grow_s * du / 12.0, rate_s * du / 12.0  # what the trapezium leaves out
    sum_x = sum_y = sum_qx = sum_qy = sum_rate = 0.0
    px = py = qx = qy = 0.0  # stress and its derivative
    u, bound, i = 1.0, 0.0, 0
    while i < nx:
        # adhesion, cell by cell; the sums over all of them
        begin, begin_u, begin_x, begin_y = i, u, px, py
        while i < nx:
            middle = u - 0.5 * du
            next_u = 1.0 - (i + 1) * du
            next_bound = max(1.0 - next_u * next_u, 0.0)
            straight = grow_y + grow_s * middle
            next_x, next_y = px + grow_x, py + straight
            size2 = next_x * next_x + next_y * next_y
            if size2 > next_bound * next_bound:
                break
            px, py = next_x, next_y
            u, bound = next_u, next_bound
            i += 1
        cells = i - begin
        if cells > 0:
            slope_y, bend_y = 0.5 * (grow_y + grow_s * begin_u), grow_s * du * cells / 6.0
            sum_x += cells * (begin_x + 0.5 * cells * grow_x)
            sum_y += cells * (begin_y + cells * (slope_y - bend_y))
            sum_qx += cells * (qx + 0.5 * cells * rate_x)
            rate_slope, rate_bend = 0.5 * (rate_y + rate_s * begin_u), rate_s * du * cells / 6.0
            sum_qy += cells * (qy + cells * (rate_slope - rate_bend))
            qx += cells * rate_x
            qy += cells * (2.0 * rate_slope - 3.0 * rate_bend)
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
        square = stick * stick
        sum_x += 0.5 * stick * (px + end_x)
        sum_y += 0.5 * stick * (py + end_y) + curved * square * stick
        sum_qx += 0.5 * stick * (qx + end_qx)
        sum_qy += 0.5 * stick * (qy + end_qy) + rate_curved * square * stick
        moves = 0.0  # derivative of the share in adhesion
        if stick > 0.0:
            rises = end_x * grow_x + end_y * straight - size * (fall - 2.0 * stick * du * du)
            if rises > 1e-6 * size:  # else stress and bound touch, and the place has no derivative
                moves = -(end_x * end_qx + end_y * end_qy) / rises
                sum_qx += 0.5 * moves * (px + end_x + stick * grow_x)
                sum_qy += 0.5 * moves * (py + end_y + stick * straight) + 3.0 * curved * square * moves
                end_qx += moves * grow_x
                end_qy += moves * straight
        else:
            size = before
        if size == 0.0:  # at the leading edge, along the growth
            end_x, end_y, end_qx, end_qy = grow_x, grow_y + grow_s * u, rate_x, rate_y + rate_s * u
            size = math.sqrt(end_x * end_x + end_y * end_y)
        # sliding: direction of the stress, and the derivative of its angle
        inverse = 1.0 / size
        out_x, out_y = end_x * inverse, end_y * inverse
        turns = (out_x * end_qy - out_y * end_qx) * inverse
        out_turned = out_x * along_y - out_y * along_x
        rest = 1.0 - stick
        bound += stick * du * (2.0 * u - stick * du)
        u -= stick * du
        # the rest of the cell, whose start moves, and below whole ones: the same without what is zero
        way = rest * du
        mean = bound + way * (u - _THIRD * way)
        late = 0.5 * bound + way * (2.0 * _THIRD * u - 0.25 * way)  # weighted by the share of the way
        # the direction lags behind the growth: what it meets at the end is the growth of a moment before; a rough size
        # of the growth will do
        rough = _rough_size(grow_x, grow_y + grow_s * (u - 0.5 * way))
        weight = 1.0 / (next_bound + mean + rest * rough)
        share = (next_bound + mean) * weight
        met = next_u + 0.5 * way * share
        aim_y, aim_rate = grow_y + grow_s * met, rate_y + rate_s * met
        mean_rate = late_rate = 0.0
        if moves != 0.0:
            shift = -moves * du
            mean_rate, late_rate = -_THIRD * shift * (2.0 * u + next_u), _THIRD * shift * (0.5 * way - u)
            share_rate = weight * (mean_rate * (1.0 - share) + share * moves * rough)
            aim_rate += 0.5 * grow_s * (shift * share + way * share_rate)
        aim2 = grow_x * grow_x + aim_y * aim_y
        end_x, end_y, end_turns = out_x, out_y, turns
        if aim2 > 0.0 and mean > 0.0:
            less = aim2 * (moves + rest * mean_rate / mean)
            end_x, end_y, end_turns = _turned(
                out_x, out_y, turns, grow_x, aim_y, rate_x, aim_rate, aim2, rest, mean, less
            )
        end_turned = end_x * along_y - end_y * along_x
        early, later = rest * (mean - late), rest * late
        sum_x += early * out_x + later * end_x
        sum_y += early * out_y + later * end_y
        sum_rate += early * turns * out_turned + later * end_turns * end_turned
        if moves != 0.0:
            early_rate = rest * (mean_rate - late_rate) - moves * (mean - late)
            late_rate = rest * late_rate - moves * late
            sum_qx += early_rate * out_x + late_rate * end_x
            sum_qy += early_rate * out_y + late_rate * end_y
        out_x, out_y, turns, out_turned = end_x, end_y, end_turns, end_turned
        u, bound = next_u, next_bound
        i += 1
        while i < nx:
            middle_y = grow_y + grow_s * (u - 0.5 * du)
            if grow_x * out_x + middle_y * out_y < 2.0 * u * du:
                break
            next_u = 1.0 - (i + 1) * du
            next_bound = max(1.0 - next_u * next_u, 0.0)
            mean = bound + du * (u - _THIRD * du)
            late = 0.5 * bound + du * (2.0 * _THIRD * u - 0.25 * du)
            both = next_bound + mean
            met = next_u + 0.5 * du * both / (both + _rough_size(grow_x, middle_y))
            aim_y, aim_rate = grow_y + grow_s * met, rate_y + rate_s * met
            aim2 = grow_x * grow_x + aim_y * aim_y
            end_x, end_y, end_turns = out_x, out_y, turns
            if aim2 > 0.0:
                end_x, end_y, end_turns = _turned(
                    out_x, out_y, turns, grow_x, aim_y, rate_x, aim_rate, aim2, 1.0, mean, 0.0
                )
            end_turned = end_x * along_y - end_y * along_x
            early = mean - late
            sum_x += early * out_x + late * end_x
            sum_y += early * out_y + late * end_y
            sum_rate += early * turns * out_turned + late * end_turns * end_turned
            out_x, out_y, turns, out_turned = end_x, end_y, end_turns, end_turned
            u, bound = next_u, next_bound
            i += 1
        px, py = bound * out_x, bound * out_y
        qx, qy = -py * turns, px * turns
    return sum_x, sum_y, sum_rate + sum_qx * along_x + sum_qy * along_y
