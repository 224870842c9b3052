"""The line: long alignments against closed forms, and rough rails against the spectra they are drawn from."""

from functools import cache, partial

import numpy as np
from scipy.integrate import quad, solve_ivp
from scipy.signal import periodogram, welch
from scipy.special import fresnel

from scenarios.verification.case import Case
from wheel_rail import Irregularities, Track, TrackParameters
from wheel_rail.alignment import heading_rad
from wheel_rail.irregularity_parameters import IrregularityParameters
from wheel_rail.irregularity_spectra import QUANTITIES, SPECTRA, SpectrumName
from wheel_rail.track_frame import track_frame

ALIGNMENT, SPECTRAL = "Line, alignment", "Line, irregularities"
GENSYS = "GENSYS manual, PSD of ORE B176"
AAR = "reference figures, AAR track classes"
INTEGRATED = "independent integration"

LENGTH_M = 60_000.0
RADIUS_M, TRANSITION_M, ARC_M = 700.0, 100.0, 300.0
S_CURVE_M = 1000.0  # two curves, to the left and to the right

# curves that join: length of transition and arc, radius (m); the second curve's transitions are Bloss's
FIRST_CURVE, SECOND_LENGTHS_M, EXIT_M = (80.0, 150.0, 600.0), (60.0, 120.0), 70.0
JOINED = {"compound": 300.0, "reverse": -450.0}

# the band of wave numbers over which the rms of the track classes is told, cycles/m
AAR_BAND_CPM = (0.024, 0.333)
AAR_RMS_MM: dict[SpectrumName, dict[str, float]] = {
    "aar-5": {"alignment": 3.06, "longitudinal_level": 5.08},
    "aar-6": {"alignment": 2.04, "longitudinal_level": 2.04},
}
ERRI_HIGH_M3 = {  # of wave numbers in cycles/m
    "longitudinal_level": {0.02: 4.0897e-4, 0.1: 1.0863e-5, 0.2: 1.2931e-6},
    "alignment": {0.02: 2.3194e-4, 0.1: 6.1608e-6, 0.2: 7.3333e-7},
}
THIRDS_CPM = (0.02, 0.05, 0.1, 0.2)
THIRD_OCTAVE = 2.0 ** (1.0 / 6.0)  # from the middle of the band to its ends
SEGMENT_M = 2000.0  # of Welch's method


def _closure_mm() -> float:
    """How far apart the track's places once and again round a full circle are."""
    radius_m = 200.0
    round_m = 2.0 * np.pi * radius_m
    curve = {"start_m": 100.0, "transition_m": 80.0, "length_m": round_m + 20.0, "radius_m": radius_m}
    track = Track(TrackParameters.model_validate({"length_m": 2000.0, "curves": [curve]}))
    return 1e3 * float(np.linalg.norm(_place(track, 190.0) - _place(track, 190.0 + round_m)))


def _place(track: Track, s_m: float) -> np.ndarray:
    frame = np.empty(14)
    track_frame(s_m, track.origin_m, track.table, frame)
    return frame[:3].copy()


def _s_curves() -> list[dict[str, float]]:
    return [
        {"start_m": S_CURVE_M * k + at, "transition_m": TRANSITION_M, "length_m": ARC_M, "radius_m": radius}
        for k in range(int(LENGTH_M / S_CURVE_M))
        for at, radius in ((0.0, RADIUS_M), (0.5 * S_CURVE_M, -RADIUS_M))
    ]


def _s_curves_off_mm() -> float:
    """Distance of the end of a line of S-curves, clothoids and arcs, from its closed form in complex numbers."""
    track = Track(TrackParameters.model_validate({"length_m": LENGTH_M, "curves": _s_curves()}))
    size = np.sqrt(np.pi * RADIUS_M * TRANSITION_M)
    sine, cosine = fresnel(TRANSITION_M / size)
    into, turned = size * complex(cosine, sine), 0.5 * TRANSITION_M / RADIUS_M
    swept = ARC_M / RADIUS_M
    arc = -1j * RADIUS_M * (np.exp(1j * swept) - 1.0)
    # a clothoid run backwards is its mirror image, turned by its own angle
    out = np.exp(1j * turned) * np.conj(into)
    left = into + np.exp(1j * turned) * arc + np.exp(1j * (turned + swept)) * out
    # the curve to the right begins at the heading to which the one to the left has turned
    both = left + np.exp(1j * (2.0 * turned + swept)) * np.conj(left)
    end = LENGTH_M / S_CURVE_M * both
    return 1e3 * float(np.linalg.norm(_place(track, LENGTH_M) - [end.real, end.imag, 0.0]))


@cache
def _joined_off(second_m: float) -> tuple[float, float, float]:
    """A curve and a second one of radius `second_m` that joins it, every 2 m to its end: largest errors of curvature
    (1/km), heading (urad) and place (mm) against an eighth-order integration of what the parameters say."""
    entry_m, arc_m, first_m = FIRST_CURVE
    joint_m, second_arc_m = SECOND_LENGTHS_M
    curves = [
        {"start_m": 0.0, "transition_in_m": entry_m, "length_m": arc_m, "radius_m": first_m},
        {"start_m": entry_m + arc_m, "joins_previous": True, "transition_kind": "bloss", "transition_in_m": joint_m,
         "length_m": second_arc_m, "radius_m": second_m, "transition_out_m": EXIT_M},
    ]  # fmt: skip
    parameters = TrackParameters.model_validate({"length_m": 1000.0, "curves": curves})
    track = Track(parameters)
    one, two = 1.0 / first_m, 1.0 / second_m
    pieces = (
        (entry_m, 0.0, one), (arc_m, one, one), (joint_m, one, two), (second_arc_m, two, two), (EXIT_M, two, 0.0)
    )  # fmt: skip
    worst, state, begin_m = np.zeros(3), np.zeros(3), 0.0
    for length_m, before, after in pieces:
        x = np.linspace(0.0, length_m, round(length_m / 2.0) + 1)
        along = solve_ivp(
            _bend, (0.0, length_m), state, "DOP853", x, rtol=1e-13, atol=1e-13, max_step=5.0,
            args=(length_m, before, after),
        ).y  # fmt: skip
        s_m = begin_m + x
        bend = np.array([_bend(at, state, length_m, before, after)[0] for at in x])
        place = np.array([_place(track, at)[:2] for at in s_m])
        off = (
            1e3 * (track.curvature_radpm(s_m) - bend),
            1e6 * (heading_rad(parameters, s_m) - along[0]),
            1e3 * np.hypot(*(place.T - along[1:])),
        )
        worst = np.maximum(worst, np.abs(off).max(axis=1))
        state, begin_m = along[:, -1], begin_m + length_m
    curvature_off, heading_off, place_off = worst.tolist()
    return curvature_off, heading_off, place_off


def _bend(x_m: float, state: np.ndarray, length_m: float, before: float, after: float) -> list[float]:
    """Slopes of heading and place: the first transition is a clothoid, the second curve's are Bloss's cubic."""
    u = x_m / length_m
    share = u * u * (3.0 - 2.0 * u) if before else u
    return [before + (after - before) * share, np.cos(state[0]), np.sin(state[0])]


def _joined_figure(second_m: float, which: int) -> float:
    return _joined_off(second_m)[which]


def _density_m3(name: SpectrumName, quantity: str, frequency_cpm: float) -> float:
    return float(SPECTRA[name].per_cycle(quantity, np.array(frequency_cpm)))


def _band_rms_mm(name: SpectrumName, quantity: str, low_cpm: float, high_cpm: float) -> float:
    """Root of the integral of the density over the band."""
    variance, _ = quad(partial(_density_m3, name, quantity), low_cpm, high_cpm)
    return 1e3 * float(np.sqrt(variance))


@cache
def _drawn(name: SpectrumName) -> Irregularities:
    return Irregularities.of(IrregularityParameters(spectrum=name), LENGTH_M, np.random.default_rng(1))


def _drawn_rms_mm(name: SpectrumName, quantity: str, low_cpm: float, high_cpm: float) -> float:
    """The same of 60 km that were drawn, by their periodogram."""
    rough = _drawn(name)
    frequency, density = periodogram(rough.values_m[:, QUANTITIES.index(quantity)], 1.0 / rough.cell_m)
    inside = (frequency >= low_cpm) & (frequency <= high_cpm)
    return 1e3 * float(np.sqrt(density[inside].sum() * frequency[1]))


def _third_octave_ratio(name: SpectrumName, quantity: str, middle_cpm: float) -> float:
    """Power within a third of an octave of 60 km that were drawn, by Welch's method, over that of the spectrum."""
    rough = _drawn(name)
    values = rough.values_m[:, QUANTITIES.index(quantity)]
    frequency, density = welch(values, 1.0 / rough.cell_m, nperseg=round(SEGMENT_M / rough.cell_m))
    inside = (frequency > middle_cpm / THIRD_OCTAVE) & (frequency < middle_cpm * THIRD_OCTAVE)
    return float(density[inside].sum() / SPECTRA[name].per_cycle(quantity, frequency[inside]).sum())


def _third_octave_spread(middle_cpm: float) -> float:
    """Standard deviation of that ratio: one over the root of the band's width times the line's length."""
    return float(1.0 / np.sqrt((THIRD_OCTAVE - 1.0 / THIRD_OCTAVE) * middle_cpm * LENGTH_M))


def _words(quantity: str) -> str:
    return quantity.replace("_", " ")


CASES = (
    Case(
        "track-circle-closes", ALIGNMENT, "distance of the ends of a full circle, R = 200 m", "closed form",
        (0.0, 1e-5), "mm", _closure_mm,
    ),
    Case(
        "track-60-km", ALIGNMENT, "error of the place at the end of 60 km of S-curves, R = 700 m: Fresnel integrals",
        "closed form", (0.0, 1e-3), "mm", _s_curves_off_mm,
    ),
    *(
        Case(
            f"track-{name}-{quantity}", ALIGNMENT,
            f"{name} curve, R = {FIRST_CURVE[2]:g} m to {radius:g} m: largest error of {quantity} along it", INTEGRATED,
            (0.0, bound), unit, partial(_joined_figure, radius, which),
        )
        for name, radius in JOINED.items()
        for which, (quantity, bound, unit) in enumerate(
            (("curvature", 1e-9, "1/km"), ("heading", 1e-3, "µrad"), ("place", 1e-5, "mm"))
        )
    ),
    *(
        Case(
            f"track-density-{quantity}-{frequency:g}", SPECTRAL,
            f"ERRI B176 high: density of the {_words(quantity)} at {frequency:g} cycles/m", GENSYS, density, "m³",
            partial(_density_m3, "erri-b176-high", quantity, frequency), 1e-3, relative=True,
        )
        for quantity, densities in ERRI_HIGH_M3.items()
        for frequency, density in densities.items()
    ),
    *(
        Case(
            f"track-rms-{how}-{name}-{quantity}", SPECTRAL,
            f"{name}: rms of the {_words(quantity)} over 0.024 to 0.333 cycles/m, {text}", AAR, rms, "mm",
            partial(obtain, name, quantity, *AAR_BAND_CPM), tolerance, relative=True,
        )
        for name, levels in AAR_RMS_MM.items()
        for quantity, rms in levels.items()
        # drawn: three standard deviations of the rms of 60 km
        for how, text, obtain, tolerance in (
            ("spectrum", "of the spectrum", _band_rms_mm, 0.003), ("drawn", "of 60 km drawn", _drawn_rms_mm, 0.06)
        )
    ),
    *(
        Case(
            f"track-drawn-{quantity}-{middle:g}", SPECTRAL,
            f"ERRI B176 low: power of the {_words(quantity)} in the third of an octave at {middle:g} cycles/m, 60 km "
            "drawn over the spectrum", "three standard deviations", 1.0, "-",
            partial(_third_octave_ratio, "erri-b176-low", quantity, middle), 3.0 * _third_octave_spread(middle),
        )
        for quantity in QUANTITIES
        for middle in THIRDS_CPM
    ),
)  # fmt: skip
