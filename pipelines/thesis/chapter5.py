"""Chapter 5: the eSEA with four frictions, gray box and NARX network (Tables 5.2, 5.4, 5.5)."""

from __future__ import annotations

from pipelines.thesis.reference import EstimateTable, EveryEstimate, Printed, ScoreOf, Scores, ScoreTable

OUTPUT = "link_velocity"
FRICTIONS = {
    "linear": "esea_linear",
    "Coulomb and Stribeck": "esea_coulomb_stribeck",
    "Dahl": "esea_dahl",
    "LuGre": "esea_lugre",
}
"""The thesis' names of the frictions, and our experiments."""

_STRIBECK = (
    "The thesis prints exp(+(v/v_s)²) in Eqs. 5-6 and 5-10. The Stribeck curve decays: exp(−(v/v_s)²) here."
)
_VARIANCES = (
    "The thesis' rows contradict each other: MSE and R² imply the variance of one and the same record, "
    "MSE / (1 − R²), which is 17.9 (rad/s)² from the linear and LuGre rows, but 11.7, 13.8, 16.5 and 12.9 "
    "from the Coulomb, hybrid Coulomb, Dahl and hybrid Dahl rows."
)
_UNITS = "The thesis prints I and J (Table 5.1) in m⁴; a moment of inertia is kg·m²."
_ILLEGIBLE = "The thesis' values are not legible in its text, so ours have no reference beside them."
_SIGMA = (
    "Dahl and LuGre are written with the pre-sliding displacement s [rad]: the thesis' stiffness is f_c / s."
)


def _rows(role: str, thesis: dict[str, tuple[Printed, Printed]]) -> tuple[Scores, ...]:
    rows = []
    for friction, (gray, hybrid) in thesis.items():
        experiment = FRICTIONS[friction]
        rows += [
            Scores(friction, gray, ScoreOf(experiment, role, OUTPUT)),
            Scores(f"{friction}, hybrid", hybrid, ScoreOf(experiment, role, OUTPUT, "hybrid"), friction),
        ]
    return tuple(rows)


TABLES = (
    EstimateTable(
        "5.2",
        "eSEA, estimates of the frictions",
        tuple(EveryEstimate(friction, experiment) for friction, experiment in FRICTIONS.items()),
        (_ILLEGIBLE, _SIGMA, _STRIBECK, _UNITS),
    ),
    ScoreTable(
        "5.4",
        "eSEA, identification record, gray box and hybrid",
        "mse",
        "(rad/s)²",
        _rows(
            "identification",
            {
                "linear": (Printed(3.3253, 0.8989), Printed(0.5018, 0.9847, 84.91)),
                "Coulomb and Stribeck": (Printed(4.5041, 0.8630), Printed(0.4765, 0.9855, 89.42)),
                "Dahl": (Printed(4.1782, 0.8729), Printed(2.2018, 0.9330, 47.30)),
                "LuGre": (Printed(1.7023, 0.9482), Printed(0.6648, 0.9798, 60.95)),
            },
        ),
        (_STRIBECK,),
    ),
    ScoreTable(
        "5.5",
        "eSEA, validation record, gray box and hybrid",
        "mse",
        "(rad/s)²",
        _rows(
            "validation",
            {
                "linear": (Printed(1.3800, 0.9229), Printed(0.5346, 0.9701, 61.26)),
                "Coulomb and Stribeck": (Printed(1.5279, 0.8695), Printed(1.2974, 0.9059, 15.09)),
                "Dahl": (Printed(1.0859, 0.9341), Printed(1.3813, 0.8933, -27.20)),
                "LuGre": (Printed(0.7609, 0.9575), Printed(0.7225, 0.9596, 5.05)),
            },
        ),
        (_VARIANCES, _STRIBECK),
    ),
)
