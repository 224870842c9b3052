"""exp, atan and the cube root of lanes (`wheel_rail.lanes`), each to two units in the last place; small things besides.

Polynomials are near-minimax on the reduced range, fitted with Chebyshev's nodes in 40 digits, their error below 1e-17;
they are summed in pairs, since a chain of twelve dependent sums would take longer than all else.
"""

import math
from typing import Any

import numpy as np
from llvmlite import ir
from numba.extending import overload

from wheel_rail.compiled import inlined
from wheel_rail.lanes import BITS, DOUBLES, LANES_TYPE, Lanes, LanesType, intrinsic, where

_SHIFT = 6755399441055744.0  # 1.5 * 2^52: added to a small number, leaves it rounded in the lowest bits
_LN2_HIGH, _LN2_LOW = 0.6931471803691238, 1.9082149292705878e-10
_TAN_22, _TAN_67 = 0.41421356237309503, 2.414213562373095  # tangents of 22.5 and 67.5 degrees
_LEAST_POWER = -700.0  # exp of less is taken as that: 1e-304


def _bits(value: int) -> Any:
    return ir.Constant(BITS, [value] * BITS.count)


@intrinsic
def _two_to(_typing: Any, shifted: Any) -> Any:
    """2^k, where k + 1.5 * 2^52 is given."""

    def code(_context: Any, builder: Any, _sig: Any, args: Any) -> Any:
        exponent = builder.shl(builder.bitcast(args[0], BITS), _bits(52))
        return builder.bitcast(builder.add(exponent, _bits(1023 << 52)), DOUBLES)

    return LANES_TYPE(shifted), code


@intrinsic
def _rough_cube_root(_typing: Any, value: Any) -> Any:
    """Within 4 %: a third of the exponent, by a third of the bits; for normal numbers above 0."""

    def code(_context: Any, builder: Any, _sig: Any, args: Any) -> Any:
        bits = builder.sitofp(builder.bitcast(args[0], BITS), DOUBLES)
        third = builder.fmul(bits, ir.Constant(DOUBLES, [1.0 / 3.0] * DOUBLES.count))
        root = builder.add(builder.fptosi(third, BITS), _bits(0x2A9F7893782DA1CE))
        return builder.bitcast(root, DOUBLES)

    return LANES_TYPE(value), code


def _exp(x: Lanes) -> Lanes:
    x = where(x < _LEAST_POWER, _LEAST_POWER, x)
    shifted = x * 1.4426950408889634 + _SHIFT
    k = shifted - _SHIFT
    r = (x - k * _LN2_HIGH) - k * _LN2_LOW
    r2 = r * r
    r4 = r2 * r2
    low = (1.0 + r) + r2 * (0.50000000000000184 + r * 0.166666666666666808)
    middle = (0.0416666666664879525 + r * 0.00833333333331958962) + r2 * (
        0.00138888889523528629 + r * 0.000198412698900764028
    )
    high = (0.000024801485441561313 + r * 2.75572408872298686e-6) + r2 * (
        2.76326547225277919e-7 + r * 2.51100492048186598e-8
    )
    return (low + r4 * (middle + r4 * high)) * _two_to(shifted)


def _atan(x: Lanes) -> Lanes:
    size = abs(x)
    steep, middling = size > _TAN_67, size > _TAN_22
    # atan x = pi/2 - atan 1/x = pi/4 + atan (x - 1)/(x + 1)
    z = where(steep, -1.0, where(middling, size - 1.0, size)) / where(steep, size, where(middling, size + 1.0, 1.0))
    begin = where(steep, 1.5707963267948966, where(middling, 0.7853981633974483, 0.0))
    z2 = z * z
    z4 = z2 * z2
    z8 = z4 * z4
    low = (-0.333333333333331209 + z2 * 0.199999999999408373) + z4 * (-0.142857142792449685 + z2 * 0.111111107446570996)
    middle = (-0.0909089680147281344 + z2 * 0.0769204519456148147) + z4 * (
        -0.0666295024603679127 + z2 * 0.0584686675227513898
    )
    high = (-0.0503504979531243932 + z2 * 0.037963903161110833) - z4 * 0.0178038963948125632
    angle = begin + (z + z * z2 * (low + z8 * (middle + z8 * high)))
    return where(x < 0.0, -angle, angle)


def _cube_root(x: Lanes) -> Lanes:
    y = _rough_cube_root(x)
    # Halley's steps: 0.04, 3e-5, 2e-14, rounding
    for _ in range(3):
        cube = y * y * y
        y = y * (cube + (x + x)) / ((cube + cube) + x)
    return y


def cube_root(x: Lanes) -> Lanes:
    """Of floats, or of lanes that are normal numbers above 0."""
    return np.cbrt(x)


@overload(cube_root)
def _cube_root_of(x: Lanes) -> Any:
    return _cube_root if isinstance(x, LanesType) else cube_root


@overload(math.exp)
def _exp_of(x: Lanes) -> Any:
    return _exp if isinstance(x, LanesType) else None


@overload(math.atan)
def _atan_of(x: Lanes) -> Any:
    return _atan if isinstance(x, LanesType) else None


@inlined
def over_root(y: Lanes) -> Lanes:
    """1/sqrt(1 + y) of floats and lanes, for small y: to rounding up to 0.004, to 3e-15 at 0.01 and 5e-11 at 0.04.

    For vectors that are nearly of unit length already; a root and a quotient would take four times as long.
    """
    y2 = y * y
    return (1.0 - y * (0.5 - 0.375 * y)) - (y * y2) * ((0.3125 - 0.2734375 * y) + y2 * (0.24609375 - 0.2255859375 * y))
