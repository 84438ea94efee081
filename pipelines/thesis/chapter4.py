"""Chapter 4: the vehicle over a bump, half-car and NARX networks (Tables 4.2 to 4.5)."""

from __future__ import annotations

from pipelines.thesis.reference import (
    Estimates,
    EstimateTable,
    NetworkOf,
    ParameterOf,
    Printed,
    ScoreOf,
    Scores,
    ScoreTable,
)

EXPERIMENT = "vehicle_narx"
VELOCITY, PITCH = "vertical_velocity", "pitch_rate"
_UNITS = "The thesis prints I_yy in kg·m⁴; a moment of inertia is kg·m²."
_TYRE = "k_t of the thesis' tables is k_p of its half-car equations: one tyre stiffness."
_HELD_OUT = (
    "The thesis has no held-out record: it scores its hybrid on the training record. The rows of the "
    "held-out speed are ours alone: they are at 15 km/h; gray box and networks were fitted at 20 km/h only."
)
_GRAY = "gray box"
_GRAY_HELD_OUT = "gray box, held-out speed"


def _gray(output: str, thesis: Printed) -> tuple[Scores, ...]:
    return (
        Scores(_GRAY, thesis, ScoreOf(EXPERIMENT, "identification", output)),
        Scores(_GRAY_HELD_OUT, None, ScoreOf(EXPERIMENT, "validation", output)),
    )


def _grid(output: str, gray: Printed, networks: dict[tuple[int, int], Printed]) -> tuple[Scores, ...]:
    """The gray box, then every network by (neurons a layer, hidden layers), then all again held out."""
    seen, held_out = _gray(output, gray)
    of = [(width, depth, printed) for (width, depth), printed in networks.items()]
    return (
        seen,
        *(_network(output, "identification", w, d, printed, _GRAY) for w, d, printed in of),
        held_out,
        *(_network(output, "validation", w, d, None, _GRAY_HELD_OUT) for w, d, _ in of),
    )


def _network(output: str, role: str, width: int, depth: int, thesis: Printed | None, against: str) -> Scores:
    label = f"{depth} layers × {width}" + ("" if role == "identification" else ", held-out speed")
    return Scores(label, thesis, NetworkOf(EXPERIMENT, role, output, depth, width), against)


_GRAY_VELOCITY, _GRAY_PITCH = Printed(0.0678, 0.8474), Printed(0.0533, 0.8682)

TABLES = (
    EstimateTable(
        "4.2",
        "half-car, estimates of the gray box",
        tuple(
            Estimates(name, value, ParameterOf(EXPERIMENT, name))
            for name, value in (
                ("I_yy", 2441.0),
                ("k_f", 22223.0),
                ("k_r", 52916.0),
                ("c_f", 2273.6),
                ("c_r", 1938.6),
                ("k_t", 5.1148e6),
            )
        ),
        (_UNITS, _TYRE),
    ),
    ScoreTable(
        "4.3", "half-car, gray box, vertical velocity", "rmse", "m/s", _gray(VELOCITY, _GRAY_VELOCITY),
        (_HELD_OUT,),
    ),
    ScoreTable(
        "4.3", "half-car, gray box, pitch rate", "rmse", "rad/s", _gray(PITCH, _GRAY_PITCH), (_HELD_OUT,)
    ),
    ScoreTable(
        "4.4",
        "half-car and NARX, vertical velocity",
        "rmse",
        "m/s",
        _grid(
            VELOCITY,
            _GRAY_VELOCITY,
            {
                (8, 3): Printed(0.0522, 0.9093), (8, 4): Printed(0.0579, 0.8886),
                (8, 5): Printed(0.0289, 0.9723),
                (16, 3): Printed(0.0410, 0.9442), (16, 4): Printed(0.0108, 0.9961),
                (16, 5): Printed(0.0232, 0.9821),
                (32, 3): Printed(0.0607, 0.8776), (32, 4): Printed(0.0420, 0.9415),
                (32, 5): Printed(0.0722, 0.8267),
            },
        ),
        (_HELD_OUT,),
    ),
    ScoreTable(
        "4.5",
        "half-car and NARX, pitch rate",
        "rmse",
        "rad/s",
        _grid(
            PITCH,
            _GRAY_PITCH,
            {
                (8, 3): Printed(0.0247, 0.9716), (8, 4): Printed(0.0215, 0.9786),
                (8, 5): Printed(0.0270, 0.9661),
                (16, 3): Printed(0.0160, 0.9881), (16, 4): Printed(0.0177, 0.9854),
                (16, 5): Printed(0.0181, 0.9848),
                (32, 3): Printed(0.0164, 0.9874), (32, 4): Printed(0.0231, 0.9752),
                (32, 5): Printed(0.0203, 0.9809),
            },
        ),
        (_HELD_OUT,),
    ),
)  # fmt: skip
