"""The line: long alignments against closed forms, and rough rails against the spectra they are drawn from."""

from functools import cache, partial

import numpy as np
from scipy.integrate import quad
from scipy.signal import periodogram, welch
from scipy.special import fresnel

from scenarios.verification.case import Case
from wheel_rail import Irregularities, Track, TrackParameters
from wheel_rail.irregularity_parameters import IrregularityParameters
from wheel_rail.irregularity_spectra import QUANTITIES, SPECTRA, SpectrumName
from wheel_rail.track import track_frame

ALIGNMENT, SPECTRAL = "Line, alignment", "Line, irregularities"
GENSYS = "GENSYS manual, PSD of ORE B176"
AAR = "reference figures, AAR track classes"

LENGTH_M = 60_000.0
RADIUS_M, TRANSITION_M, ARC_M = 700.0, 100.0, 300.0
S_CURVE_M = 1000.0  # two curves, to the left and to the right

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
