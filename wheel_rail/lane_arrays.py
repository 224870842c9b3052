"""Lanes (`wheel_rail.lanes`) from arrays, and back.

Arrays are contiguous, of any shape, and counted through; nothing is checked. With a `stride` the floats stand at
`offset`, `offset + stride` ...: one for each wheel, or for each wheelset one or a pair. With `places`, an array of
integers, they stand `shift` behind the eight places from `first` on.
"""

from typing import Any

from llvmlite import ir
from numba import types

from wheel_rail.lanes import DOUBLES, LANES, LANES_TYPE, intrinsic

_UNALIGNED = 8  # what arrays of doubles promise


def _place(context: Any, builder: Any, kind: Any, array: Any, offset: Any) -> Any:
    """Pointer to the float so many floats behind the begin of an array."""
    return builder.gep(context.make_array(kind)(context, builder, array).data, [offset])


@intrinsic
def lanes_at(_typing: Any, array: Any, offset: Any) -> Any:
    """The eight floats from `offset` on."""

    def code(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        place = _place(context, builder, sig.args[0], *args)
        return builder.load(builder.bitcast(place, DOUBLES.as_pointer()), align=_UNALIGNED)

    return LANES_TYPE(array, types.intp), code


@intrinsic
def put_lanes(_typing: Any, array: Any, offset: Any, value: Any) -> Any:
    """Write eight floats from `offset` on."""

    def code(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        place = _place(context, builder, sig.args[0], args[0], args[1])
        builder.store(args[2], builder.bitcast(place, DOUBLES.as_pointer()), align=_UNALIGNED)
        return context.get_dummy_value()

    return types.none(array, types.intp, LANES_TYPE), code


def _places(context: Any, builder: Any, sig: Any, args: Any, count: int) -> list[Any]:
    """Pointers to so many floats, a stride apart."""
    array, offset, stride = args[:3]
    return [
        _place(context, builder, sig.args[0], array, builder.add(offset, builder.mul(stride, stride.type(k))))
        for k in range(count)
    ]


def _strided(context: Any, builder: Any, sig: Any, args: Any, count: int) -> list[Any]:
    return [builder.load(place) for place in _places(context, builder, sig, args, count)]


@intrinsic
def of_wheels(_typing: Any, array: Any, offset: Any, stride: Any) -> Any:
    """One float for each wheel."""

    def code(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        vector = ir.Constant(DOUBLES, ir.Undefined)
        for k, value in enumerate(_strided(context, builder, sig, args, LANES)):
            vector = builder.insert_element(vector, value, ir.IntType(32)(k))
        return vector

    return LANES_TYPE(array, types.intp, types.intp), code


@intrinsic
def of_wheelsets(_typing: Any, array: Any, offset: Any, stride: Any) -> Any:
    """One float for each wheelset, in the lanes of its left and its right wheel."""

    def code(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        four = ir.Constant(ir.VectorType(ir.DoubleType(), LANES // 2), ir.Undefined)
        for k, value in enumerate(_strided(context, builder, sig, args, LANES // 2)):
            four = builder.insert_element(four, value, ir.IntType(32)(k))
        twice = ir.Constant(ir.VectorType(ir.IntType(32), LANES), [k // 2 for k in range(LANES)])
        return builder.shuffle_vector(four, four, twice)

    return LANES_TYPE(array, types.intp, types.intp), code


@intrinsic
def of_pairs(_typing: Any, array: Any, offset: Any, stride: Any) -> Any:
    """Two floats side by side for each wheelset: of its left and its right wheel."""

    def code(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        pair = ir.VectorType(ir.DoubleType(), 2)
        pairs = [
            builder.load(builder.bitcast(place, pair.as_pointer()), align=_UNALIGNED)
            for place in _places(context, builder, sig, args, LANES // 2)
        ]
        return _joined(builder, _joined(builder, pairs[0], pairs[1]), _joined(builder, pairs[2], pairs[3]))

    return LANES_TYPE(array, types.intp, types.intp), code


def _joined(builder: Any, low: Any, high: Any) -> Any:
    """One vector of two of the same size."""
    order = list(range(2 * low.type.count))
    return builder.shuffle_vector(low, high, ir.Constant(ir.VectorType(ir.IntType(32), len(order)), order))


@intrinsic
def put_four(_typing: Any, array: Any, offset: Any, value: Any) -> Any:
    """Write the first four lanes from `offset` on."""

    def code(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        place, value = _place(context, builder, sig.args[0], args[0], args[1]), args[2]
        order = ir.Constant(ir.VectorType(ir.IntType(32), LANES // 2), list(range(LANES // 2)))
        four = builder.shuffle_vector(value, value, order)
        builder.store(four, builder.bitcast(place, four.type.as_pointer()), align=_UNALIGNED)
        return context.get_dummy_value()

    return types.none(array, types.intp, LANES_TYPE), code


@intrinsic
def put_wheelsets(_typing: Any, array: Any, offset: Any, stride: Any, value: Any) -> Any:
    """Write one float for each wheelset, the sum of its two wheels' lanes."""

    def code(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        value = args[3]
        index = ir.VectorType(ir.IntType(32), LANES // 2)
        left, right = ([2 * k + side for k in range(LANES // 2)] for side in range(2))
        total = builder.fadd(
            builder.shuffle_vector(value, value, ir.Constant(index, left)),
            builder.shuffle_vector(value, value, ir.Constant(index, right)),
        )
        for k, place in enumerate(_places(context, builder, sig, args, LANES // 2)):
            builder.store(builder.extract_element(total, ir.IntType(32)(k)), place)
        return context.get_dummy_value()

    return types.none(array, types.intp, types.intp, LANES_TYPE), code


def _placed(context: Any, builder: Any, sig: Any, args: Any) -> list[Any]:
    """Pointers to the floats at eight places."""
    array, places, first, shift = args[:4]
    return [
        _place(
            context,
            builder,
            sig.args[0],
            array,
            builder.add(
                builder.load(_place(context, builder, sig.args[1], places, builder.add(first, first.type(k)))), shift
            ),
        )
        for k in range(LANES)
    ]


@intrinsic
def of_places(_typing: Any, array: Any, places: Any, first: Any, shift: Any) -> Any:
    """The float at each place."""

    def code(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        vector = ir.Constant(DOUBLES, ir.Undefined)
        for k, place in enumerate(_placed(context, builder, sig, args)):
            vector = builder.insert_element(vector, builder.load(place), ir.IntType(32)(k))
        return vector

    return LANES_TYPE(array, places, types.intp, types.intp), code


@intrinsic
def add_at_places(_typing: Any, array: Any, places: Any, first: Any, shift: Any, value: Any) -> Any:
    """Add a lane to the float at each place, one after the other: places may be alike."""

    def code(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        for k, place in enumerate(_placed(context, builder, sig, args)):
            lane = builder.extract_element(args[4], ir.IntType(32)(k))
            builder.store(builder.fadd(builder.load(place), lane), place)
        return context.get_dummy_value()

    return types.none(array, places, types.intp, types.intp, LANES_TYPE), code
