"""Eight numbers at once in compiled code: a type `lanes`, one vector register with a lane for each wheel of a coach.

The eight contacts are the same arithmetic eight times. Functions written for floats take lanes as well when they choose
with `where` instead of branches: arithmetic, comparisons, sqrt, exp, atan and cbrt are defined for both. Each operation
is the IEEE one of every lane; only exp, atan and cbrt are worked out here, to a few units in the last place.

Lanes live inside of compiled functions: they come from arrays (`lanes_at`, `of_wheelsets`, `of_wheels`) and go back to
them (`put_lanes`, `put_wheelsets`). Not into lists: numba lays those out without the alignment that a register wants.
"""

import math
import operator
from collections.abc import Callable
from typing import Any

from llvmlite import ir
from numba import types
from numba.core import cgutils
from numba.core.typing.templates import AbstractTemplate, infer_global, signature
from numba.extending import intrinsic, lower_builtin, lower_cast, models, register_model

LANES = 8

Lanes = Any  # the compiled type, as Python's annotations see it: eight floats, or one for all
Mask = Any  # eight booleans, or one

_DOUBLES = ir.VectorType(ir.DoubleType(), LANES)
_BITS = ir.VectorType(ir.IntType(64), LANES)
_UNALIGNED = 8  # what arrays of doubles promise


class LanesType(types.Type):  # type: ignore[misc]
    """Numba's type of eight doubles."""

    def __init__(self) -> None:
        super().__init__(name="lanes")


class MaskType(types.Type):  # type: ignore[misc]
    """Numba's type of what comparing lanes gives."""

    def __init__(self) -> None:
        super().__init__(name="mask")


LANES_TYPE, MASK_TYPE = LanesType(), MaskType()


@register_model(LanesType)
class _LanesModel(models.PrimitiveModel):  # type: ignore[misc]
    def __init__(self, manager: Any, fe_type: Any) -> None:
        super().__init__(manager, fe_type, _DOUBLES)


@register_model(MaskType)
class _MaskModel(models.PrimitiveModel):  # type: ignore[misc]
    def __init__(self, manager: Any, fe_type: Any) -> None:
        super().__init__(manager, fe_type, ir.VectorType(ir.IntType(1), LANES))


def _repeated(builder: Any, value: Any) -> Any:
    """The vector with this scalar in every lane."""
    alone = builder.insert_element(ir.Constant(_DOUBLES, ir.Undefined), value, ir.IntType(32)(0))
    return builder.shuffle_vector(
        alone, ir.Constant(_DOUBLES, ir.Undefined), ir.Constant(ir.VectorType(ir.IntType(32), LANES), [0] * LANES)
    )


@lower_cast(types.Float, LanesType)
def _lanes_of_float(context: Any, builder: Any, fromty: Any, _toty: Any, value: Any) -> Any:
    return _repeated(builder, context.cast(builder, value, fromty, types.float64))


def _define_operator(function: Callable[..., Any], kind: Any, result: Any, code: Callable[..., Any]) -> None:
    """`function` on operands of which one is of `kind` and the others are of it too, or floats beside lanes."""
    others = (LanesType, types.Float) if kind is LANES_TYPE else (MaskType,)

    class Template(AbstractTemplate):  # type: ignore[misc]
        def generic(self, args: Any, kws: Any) -> Any:
            if not kws and kind in args and all(isinstance(arg, others) for arg in args):
                return signature(result, *(kind for _ in args))
            return None

    infer_global(function)(Template)

    def lowered(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        return code(builder, *args)

    for count in (1, 2):
        lower_builtin(function, *(kind,) * count)(lowered)


def _of_intrinsic(name: str) -> Callable[..., Any]:
    def code(builder: Any, value: Any) -> Any:
        kind = ir.FunctionType(_DOUBLES, [_DOUBLES])
        return builder.call(cgutils.get_or_insert_function(builder.module, kind, f"{name}.v{LANES}f64"), [value])

    return code


for _plain, _in_place, _instruction in (
    (operator.add, operator.iadd, "fadd"),
    (operator.sub, operator.isub, "fsub"),
    (operator.mul, operator.imul, "fmul"),
    (operator.truediv, operator.itruediv, "fdiv"),
):
    for _function in (_plain, _in_place):
        _define_operator(
            _function, LANES_TYPE, LANES_TYPE, lambda builder, a, b, name=_instruction: getattr(builder, name)(a, b)
        )
for _function, _sign in ((operator.lt, "<"), (operator.le, "<="), (operator.gt, ">"), (operator.ge, ">=")):
    _define_operator(
        _function, LANES_TYPE, MASK_TYPE, lambda builder, a, b, sign=_sign: builder.fcmp_ordered(sign, a, b)
    )
_define_operator(operator.neg, LANES_TYPE, LANES_TYPE, lambda builder, a: builder.fneg(a))
_define_operator(operator.and_, MASK_TYPE, MASK_TYPE, lambda builder, a, b: builder.and_(a, b))
_define_operator(operator.or_, MASK_TYPE, MASK_TYPE, lambda builder, a, b: builder.or_(a, b))
_define_operator(abs, LANES_TYPE, LANES_TYPE, _of_intrinsic("llvm.fabs"))
_define_operator(math.sqrt, LANES_TYPE, LANES_TYPE, _of_intrinsic("llvm.sqrt"))


def where(mask: Mask, a: Lanes, b: Lanes) -> Lanes:
    """`a` in the lanes where `mask` holds, else `b`; both are worked out."""
    return a if mask else b


def greater(a: Lanes, b: Lanes) -> Lanes:
    """The greater of two in each lane; `b` where one is no number."""
    return where(a > b, a, b)


def lesser(a: Lanes, b: Lanes) -> Lanes:
    """The lesser of two in each lane; `b` where one is no number."""
    return where(a < b, a, b)


def _choosing(function: Callable[..., Any], code: Callable[..., Any]) -> None:
    """`function` on (mask and) two floats or lanes, lanes if one of them is."""
    masks = function.__code__.co_argcount - 2

    class Template(AbstractTemplate):  # type: ignore[misc]
        def generic(self, args: Any, kws: Any) -> Any:
            if kws or not all(isinstance(arg, (LanesType, types.Float)) for arg in args[masks:]):
                return None
            wide = LANES_TYPE in args[masks:] or MASK_TYPE in args[:masks]
            kind = LANES_TYPE if wide else types.float64
            return signature(kind, *((MASK_TYPE if wide else types.boolean,) * masks), kind, kind)

    infer_global(function)(Template)

    def lowered(_context: Any, builder: Any, _sig: Any, args: Any) -> Any:
        return code(builder, *args)

    for kind, mask in ((LANES_TYPE, MASK_TYPE), (types.float64, types.boolean)):
        lower_builtin(function, *(mask,) * masks, kind, kind)(lowered)


_choosing(where, lambda builder, mask, a, b: builder.select(mask, a, b))
_choosing(greater, lambda builder, a, b: builder.select(builder.fcmp_ordered(">", a, b), a, b))
_choosing(lesser, lambda builder, a, b: builder.select(builder.fcmp_ordered("<", a, b), a, b))


def every(mask: Mask) -> bool:
    """Whether it holds in every lane."""
    return bool(mask)


def some(mask: Mask) -> bool:
    """Whether it holds in any lane."""
    return bool(mask)


def _define_test(function: Callable[..., Any], predicate: str, value: int) -> None:
    class Template(AbstractTemplate):  # type: ignore[misc]
        def generic(self, args: Any, kws: Any) -> Any:
            return signature(types.boolean, *args) if args in ((MASK_TYPE,), (types.boolean,)) else None

    infer_global(function)(Template)

    def of_mask(_context: Any, builder: Any, _sig: Any, args: Any) -> Any:
        bits = ir.IntType(LANES)
        return builder.icmp_unsigned(predicate, builder.bitcast(args[0], bits), bits(value))

    lower_builtin(function, MASK_TYPE)(of_mask)
    lower_builtin(function, types.boolean)(lambda _context, _builder, _sig, args: args[0])


_define_test(every, "==", -1)
_define_test(some, "!=", 0)


@intrinsic
def lane(_typing: Any, value: Any, number: Any) -> Any:
    """One lane of lanes, a float."""

    def code(_context: Any, builder: Any, _sig: Any, args: Any) -> Any:
        return builder.extract_element(args[0], args[1])

    return types.float64(value, number), code


@intrinsic
def lanes_of(_typing: Any, values: Any) -> Any:
    """Lanes from a tuple of eight floats."""

    def code(_context: Any, builder: Any, _sig: Any, args: Any) -> Any:
        vector = ir.Constant(_DOUBLES, ir.Undefined)
        for k in range(LANES):
            vector = builder.insert_element(vector, builder.extract_value(args[0], k), ir.IntType(32)(k))
        return vector

    return LANES_TYPE(values), code


def _place(context: Any, builder: Any, kind: Any, array: Any, offset: Any) -> Any:
    """Pointer to the float so many floats behind the begin of a contiguous array of any shape."""
    return builder.gep(context.make_array(kind)(context, builder, array).data, [offset])


@intrinsic
def lanes_at(_typing: Any, array: Any, offset: Any) -> Any:
    """The eight floats from `offset` on, in a contiguous array counted through."""

    def code(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        place = _place(context, builder, sig.args[0], *args)
        return builder.load(builder.bitcast(place, _DOUBLES.as_pointer()), align=_UNALIGNED)

    return LANES_TYPE(array, types.intp), code


@intrinsic
def put_lanes(_typing: Any, array: Any, offset: Any, value: Any) -> Any:
    """Write eight floats from `offset` on."""

    def code(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        place = _place(context, builder, sig.args[0], args[0], args[1])
        builder.store(args[2], builder.bitcast(place, _DOUBLES.as_pointer()), align=_UNALIGNED)
        return context.get_dummy_value()

    return types.none(array, types.intp, LANES_TYPE), code


def _strided(context: Any, builder: Any, sig: Any, args: Any, count: int) -> list[Any]:
    array, offset, stride = args
    return [
        builder.load(
            _place(context, builder, sig.args[0], array, builder.add(offset, builder.mul(stride, stride.type(k))))
        )
        for k in range(count)
    ]


@intrinsic
def of_wheels(_typing: Any, array: Any, offset: Any, stride: Any) -> Any:
    """The eight floats at `offset`, `offset + stride` ... of a contiguous array counted through."""

    def code(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        vector = ir.Constant(_DOUBLES, ir.Undefined)
        for k, value in enumerate(_strided(context, builder, sig, args, LANES)):
            vector = builder.insert_element(vector, value, ir.IntType(32)(k))
        return vector

    return LANES_TYPE(array, types.intp, types.intp), code


@intrinsic
def of_wheelsets(_typing: Any, array: Any, offset: Any, stride: Any) -> Any:
    """The four floats at `offset`, `offset + stride` ..., each for the left and the right wheel of a wheelset."""

    def code(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        four = ir.Constant(ir.VectorType(ir.DoubleType(), LANES // 2), ir.Undefined)
        for k, value in enumerate(_strided(context, builder, sig, args, LANES // 2)):
            four = builder.insert_element(four, value, ir.IntType(32)(k))
        twice = ir.Constant(ir.VectorType(ir.IntType(32), LANES), [k // 2 for k in range(LANES)])
        return builder.shuffle_vector(four, four, twice)

    return LANES_TYPE(array, types.intp, types.intp), code


@intrinsic
def put_wheelsets(_typing: Any, array: Any, offset: Any, stride: Any, value: Any) -> Any:
    """Write the sum of the left and the right wheel's lane to the four floats at `offset`, `offset + stride` ..."""

    def code(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        array, offset, stride, value = args
        index = ir.VectorType(ir.IntType(32), LANES // 2)
        left, right = ([2 * k + side for k in range(LANES // 2)] for side in range(2))
        total = builder.fadd(
            builder.shuffle_vector(value, value, ir.Constant(index, left)),
            builder.shuffle_vector(value, value, ir.Constant(index, right)),
        )
        for k in range(LANES // 2):
            at = builder.add(offset, builder.mul(stride, stride.type(k)))
            builder.store(
                builder.extract_element(total, ir.IntType(32)(k)), _place(context, builder, sig.args[0], array, at)
            )
        return context.get_dummy_value()

    return types.none(array, types.intp, types.intp, LANES_TYPE), code
