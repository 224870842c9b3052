"""A user's creep law: a Python function, compiled here and called from compiled code through its address.

    def law(creep_x, creep_y, spin_1pm, slip_speed_mps, normal_force_n, a_m, b_m, c11, c22, c23, shear_modulus_pa,
            mu0, falling_a, falling_b_spm, k_adhesion, k_slip):
        ...
        return fx, fy

All arguments are floats in SI units; (fx, fy) is the force on the wheel in N, against the creepages. The address is an
ordinary integer argument of the callers, whose compiled code on disk therefore serves every user's law.
"""

import inspect
import math
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from llvmlite import ir
from numba import carray, cfunc, njit, types  # type: ignore[attr-defined]
from numba.core import cgutils
from numba.extending import intrinsic

from wheel_rail.compiled import Array, Vector, compiled
from wheel_rail.kalker import creep_coefficients
from wheel_rail.slip import slip_direction, total_creep

ARGUMENTS = (
    "creep_x", "creep_y", "spin_1pm", "slip_speed_mps", "normal_force_n", "a_m", "b_m", "c11", "c22", "c23",
    "shear_modulus_pa", "mu0", "falling_a", "falling_b_spm", "k_adhesion", "k_slip",
)  # fmt: skip
"""What a user's law is called with, in this order."""


class UnusableLaw(ValueError):
    """A user's function that cannot serve as a creep law; the message says why."""


@dataclass(frozen=True)
class CompiledLaw:
    """A user's law as machine code of this process: valid here alone and as long as this object lives."""

    name: str
    address: int
    compiled: Any = field(repr=False, compare=False)


def _emit_call(typing_context: Any, address: Any, arguments: Any) -> Any:
    """Call the C function void(16 doubles, double[2]) at `address`; returns what it left in its last argument."""
    signature = types.UniTuple(types.float64, 2)(types.int64, types.UniTuple(types.float64, len(ARGUMENTS)))

    def generate(context: Any, builder: Any, signature: Any, values: Any) -> Any:
        double = ir.DoubleType()
        function = ir.FunctionType(ir.VoidType(), [double] * len(ARGUMENTS) + [double.as_pointer()])
        target = builder.inttoptr(values[0], function.as_pointer())
        result = cgutils.alloca_once(builder, ir.ArrayType(double, 2))
        first = cgutils.gep_inbounds(builder, result, 0, 0)
        builder.call(target, [*cgutils.unpack_tuple(builder, values[1], len(ARGUMENTS)), first])
        second = cgutils.gep_inbounds(builder, result, 0, 1)
        return context.make_tuple(builder, signature.return_type, [builder.load(first), builder.load(second)])

    return signature, generate


_call: Any = intrinsic(_emit_call)


@compiled
def user_force(
    address: int, creep_x: float, creep_y: float, spin_1pm: float, slip_speed_mps: float, normal_force_n: float,
    patch: Vector, rail: Array, shear_modulus_pa: float,
) -> tuple[float, float, float, float]:  # fmt: skip
    """Force of the law at `address`, arguments and results as in `polach_force`.

    The tangent is the difference to a second evaluation, a thousandth further along the slip.
    """
    rest = (
        normal_force_n, patch[0], patch[1], patch[2], patch[3], patch[4], shear_modulus_pa,
        rail[0], rail[1], rail[2], rail[3], rail[4],
    )  # fmt: skip
    fx, fy = _call(address, (creep_x, creep_y, spin_1pm, slip_speed_mps, *rest))
    along_x, along_y = slip_direction(creep_x, creep_y)
    creep = math.sqrt(creep_x * creep_x + creep_y * creep_y)
    step = 1e-3 * creep + 1e-9
    faster = slip_speed_mps * (1.0 + step / creep) if creep > 1e-14 else slip_speed_mps
    further_x, further_y = _call(address, (creep_x + step * along_x, creep_y + step * along_y, spin_1pm, faster, *rest))
    tangent = -((further_x - fx) * along_x + (further_y - fy) * along_y) / step
    total = total_creep(creep_x, creep_y, spin_1pm, patch[0])
    if total < 1e-14:
        return fx, fy, tangent, tangent
    return fx, fy, tangent, math.sqrt(fx * fx + fy * fy) / total


def compile_law(function: Callable[..., Any], name: str) -> CompiledLaw:
    """Compile the user's `function` (plain, or decorated with numba's njit) and try it at a few points.

    `name` is what messages call it. Raises UnusableLaw if it is no function, takes other than the 16 arguments, does
    not compile to two floats, raises, or is no creep law: not finite, not odd, with the slip, or beyond mu N.
    """
    plain = getattr(function, "py_func", function)
    if not inspect.isfunction(plain):
        raise UnusableLaw(f"creep law {name}: {function!r} is not a Python function")
    parameters = list(inspect.signature(plain).parameters)
    if len(parameters) != len(ARGUMENTS):
        raise UnusableLaw(
            f"creep law {name} takes {len(parameters)} arguments ({', '.join(parameters)}), "
            f"but must take {len(ARGUMENTS)}: {', '.join(ARGUMENTS)}"
        )
    law: Any = njit(error_model="numpy")(plain)
    try:
        law.compile((types.float64,) * len(ARGUMENTS))
        result = law.nopython_signatures[0].return_type
    except Exception as error:  # numba raises of many kinds
        raise UnusableLaw(f"creep law {name} does not compile: {str(error).strip()}") from error
    items: Any = result if isinstance(result, types.BaseTuple) else ()
    if not (len(items) == 2 and all(isinstance(item, types.Float | types.Integer) for item in items)):
        raise UnusableLaw(f"creep law {name} returns {result}, but must return the two floats fx, fy")
    _refuse_nonsense(law, name)

    def write_force(
        x: float, y: float, spin: float, slip: float, load: float, a: float, b: float, c11: float, c22: float,
        c23: float, modulus: float, mu0: float, fall: float, rate: float, ka: float, ks: float, out: Any,
    ) -> None:  # fmt: skip
        fx, fy = law(x, y, spin, slip, load, a, b, c11, c22, c23, modulus, mu0, fall, rate, ka, ks)
        force = carray(out, 2)
        force[0] = fx
        force[1] = fy

    signature = types.void(*(types.float64,) * len(ARGUMENTS), types.CPointer(types.float64))
    callback: Any = cfunc(signature)(write_force)
    return CompiledLaw(name, callback.address, callback)


def _refuse_nonsense(law: Callable[..., tuple[float, float]], name: str) -> None:
    """Raise UnusableLaw, quoting the point, if the law fails at one of a few points of an ordinary contact."""
    a, b, load, mu0, fall, rate = 6e-3, 7e-3, 70e3, 0.3, 0.4, 0.2
    coefficients = creep_coefficients(a / b, 0.28)

    def at(x: float, y: float, spin: float, slip: float) -> tuple[float, float]:
        point = f"at creep_x = {x:g}, creep_y = {y:g}, spin_1pm = {spin:g}, slip_speed_mps = {slip:g}"
        try:
            fx, fy = law(x, y, spin, slip, load, a, b, *coefficients, 82e9, mu0, fall, rate, 1.0, 0.4)
        except Exception as error:
            raise UnusableLaw(f"creep law {name} raises {type(error).__name__} ({error}) {point}") from error
        found = f"gives fx = {fx:.6g} N, fy = {fy:.6g} N {point}"
        limit = load * mu0 * ((1.0 - fall) * math.exp(-rate * slip) + fall)
        if not (math.isfinite(fx) and math.isfinite(fy)):
            raise UnusableLaw(f"creep law {name} {found}: not finite")
        if math.hypot(fx, fy) > limit * (1.0 + 1e-9):
            raise UnusableLaw(f"creep law {name} {found}: beyond mu N = {limit:.6g} N")
        if spin == 0.0 and fx * x + fy * y > 0.0:
            raise UnusableLaw(f"creep law {name} {found}: it drives the slip, but must oppose it")
        if x == y == spin == 0.0 and math.hypot(fx, fy) > 1e-9 * limit:
            raise UnusableLaw(f"creep law {name} {found}: there must be no force without creepage")
        return fx, fy

    for size in (0.0, 1e-12, 1e-5, 1e-3, 0.02, 1.0):
        for angle in np.linspace(0.0, np.pi, 5):
            for spin in (0.0, 0.1 * size, -100.0 * size):
                x, y = size * math.cos(angle), size * math.sin(angle)
                force, mirrored = at(x, y, spin, 20.0 * size), at(-x, -y, -spin, 20.0 * size)
                if math.dist(force, (-mirrored[0], -mirrored[1])) > 1e-6 * load * mu0:
                    raise UnusableLaw(
                        f"creep law {name} is not odd: {force} N at creepages ({x:g}, {y:g}, {spin:g} 1/m), "
                        f"{mirrored} N at the opposite ones"
                    )
