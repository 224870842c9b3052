"""Eight numbers at once in compiled code: a type `lanes`, one vector register with a lane for each wheel of a coach.

The eight contacts are the same arithmetic eight times. Functions written for floats take lanes as well when they choose
with `where` instead of branches: arithmetic, comparisons, sqrt, exp, atan and cbrt are defined for both. Each operation
is the IEEE one of every lane, or a fused product and sum; only exp, atan and cbrt are worked out here, to a few units
in the last place.

Lanes live inside of compiled functions; `wheel_rail.lane_arrays` takes them from arrays and back. They do not go into
lists: numba lays those out without the alignment that a register wants.
"""

import math
import operator
from collections.abc import Callable
from typing import Any

from llvmlite import ir
from numba import extending, types
from numba.core import cgutils
from numba.core.typing.templates import AbstractTemplate, infer_global, signature
from numba.extending import lower_builtin, lower_cast, models, register_model

LANES = 8

intrinsic: Any = extending.intrinsic  # what it decorates loses its first argument, which mypy cannot know

Lanes = Any  # the compiled type, as Python's annotations see it: eight floats, or one for all
Mask = Any  # eight booleans, or one

ZEROS = (0.0,) * LANES  # for `lanes_of`

DOUBLES = ir.VectorType(ir.DoubleType(), LANES)
BITS = ir.VectorType(ir.IntType(64), LANES)


class LanesType(types.Type):
    """Numba's type of eight doubles."""

    def __init__(self) -> None:
        super().__init__(name="lanes")


class MaskType(types.Type):
    """Numba's type of what comparing lanes gives."""

    def __init__(self) -> None:
        super().__init__(name="mask")


LANES_TYPE, MASK_TYPE = LanesType(), MaskType()


@register_model(LanesType)
class _LanesModel(models.PrimitiveModel):
    def __init__(self, manager: Any, fe_type: Any) -> None:
        super().__init__(manager, fe_type, DOUBLES)


@register_model(MaskType)
class _MaskModel(models.PrimitiveModel):
    def __init__(self, manager: Any, fe_type: Any) -> None:
        super().__init__(manager, fe_type, ir.VectorType(ir.IntType(1), LANES))


def _repeated(builder: Any, value: Any) -> Any:
    """The vector with this scalar in every lane."""
    alone = builder.insert_element(ir.Constant(DOUBLES, ir.Undefined), value, ir.IntType(32)(0))
    return builder.shuffle_vector(
        alone, ir.Constant(DOUBLES, ir.Undefined), ir.Constant(ir.VectorType(ir.IntType(32), LANES), [0] * LANES)
    )


@lower_cast(types.Float, LanesType)
def _lanes_of_float(context: Any, builder: Any, fromty: Any, _toty: Any, value: Any) -> Any:
    return _repeated(builder, context.cast(builder, value, fromty, types.float64))


def _define_operator(function: Callable[..., Any], kind: Any, result: Any, code: Callable[..., Any]) -> None:
    """`function` on operands of which one is of `kind` and the others are of it too, or floats beside lanes."""
    others = (LanesType, types.Float) if kind is LANES_TYPE else (MaskType,)

    class Template(AbstractTemplate):
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
        kind = ir.FunctionType(DOUBLES, [DOUBLES])
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
            _function,
            LANES_TYPE,
            LANES_TYPE,
            lambda builder, a, b, name=_instruction: getattr(builder, name)(a, b, flags=("contract",)),
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

    class Template(AbstractTemplate):
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
    class Template(AbstractTemplate):
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
def total(_typing: Any, value: Any) -> Any:
    """Sum of all lanes: of the halves, of their halves, and so on."""

    def code(_context: Any, builder: Any, _sig: Any, args: Any) -> Any:
        value = args[0]
        half = LANES // 2
        while half > 0:
            kind = ir.VectorType(ir.IntType(32), half)
            low, high = (ir.Constant(kind, [first + k for k in range(half)]) for first in (0, half))
            value = builder.fadd(builder.shuffle_vector(value, value, low), builder.shuffle_vector(value, value, high))
            half //= 2
        return builder.extract_element(value, ir.IntType(32)(0))

    return types.float64(value), code


@intrinsic
def swapped(_typing: Any, value: Any) -> Any:
    """The last four lanes, then the first four."""

    def code(_context: Any, builder: Any, _sig: Any, args: Any) -> Any:
        half = LANES // 2
        order = ir.Constant(ir.VectorType(ir.IntType(32), LANES), [(k + half) % LANES for k in range(LANES)])
        return builder.shuffle_vector(args[0], args[0], order)

    return LANES_TYPE(value), code


@intrinsic
def doubled(_typing: Any, value: Any) -> Any:
    """The first four lanes, each twice: from wheelsets to wheels."""

    def code(_context: Any, builder: Any, _sig: Any, args: Any) -> Any:
        order = ir.Constant(ir.VectorType(ir.IntType(32), LANES), [k // 2 for k in range(LANES)])
        return builder.shuffle_vector(args[0], args[0], order)

    return LANES_TYPE(value), code


@intrinsic
def joined(_typing: Any, first: Any, second: Any) -> Any:
    """The first four lanes of both."""

    def code(_context: Any, builder: Any, _sig: Any, args: Any) -> Any:
        half = LANES // 2
        order = ir.Constant(ir.VectorType(ir.IntType(32), LANES), [*range(half), *range(LANES, LANES + half)])
        return builder.shuffle_vector(args[0], args[1], order)

    return LANES_TYPE(first, second), code


@intrinsic
def lanes_of(_typing: Any, values: Any) -> Any:
    """Lanes from a tuple of eight floats."""

    def code(_context: Any, builder: Any, _sig: Any, args: Any) -> Any:
        vector = ir.Constant(DOUBLES, ir.Undefined)
        for k in range(LANES):
            vector = builder.insert_element(vector, builder.extract_value(args[0], k), ir.IntType(32)(k))
        return vector

    return LANES_TYPE(values), code
