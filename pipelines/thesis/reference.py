"""What the thesis printed, table by table, and which of our results stands beside each number.

Source: PUC-Rio thesis (2023), Tables 6.2 to 6.4. Where a table needs care, ``care`` says so on the page.
"""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class ParameterOf:
    """Our estimate of a parameter in an experiment."""

    experiment: str
    name: str


@dataclass(frozen=True)
class MetricOf:
    """Our score in an experiment: of the records with ``role``, one ``output`` in one ``view``."""

    experiment: str
    role: str
    output: str
    view: str
    quantity: str


@dataclass(frozen=True)
class Entry:
    """One number: its label, the thesis' value (None: the thesis has none), its unit, and ours."""

    label: str
    thesis: float | None
    unit: str
    ours: ParameterOf | MetricOf


@dataclass(frozen=True)
class ThesisTable:
    """A table of the thesis; ``care`` are the errata that bear on it."""

    number: str
    title: str
    entries: tuple[Entry, ...]
    care: tuple[str, ...] = ()


_FREE, _HORIZON, _DIRECTION = "emps_free_run", "emps_horizon", "emps_direction"
_RMSE = (
    'The thesis heads this column "MSE". It is the RMSE in metres: 1 - 0.0049²/0.006833 = 0.9965, its own R².'
)
_OPTIMUM = (
    "The thesis' gray box is not at its optimum: the same model fitted here in free run has a lower error, "
    "and other values."
)
_HORIZONS = (
    "EMPS integrates: over the whole record a 3 % change of friction grows to millimetres. The last rows "
    "score horizons of 1 s, each from its own estimated initial state; the thesis has no such view."
)


def _score(
    label: str, thesis: float | None, unit: str, experiment: str, role: str, view: str, what: str
) -> Entry:
    return Entry(label, thesis, unit, MetricOf(experiment, role, "position", view, what))


def _scores(role: str, rmse: float, r2: float) -> tuple[Entry, ...]:
    return (
        _score("gray box, free run, RMSE", rmse, "m", _FREE, role, "free_run", "rmse"),
        _score("gray box, free run, R²", r2, "", _FREE, role, "free_run", "r2"),
        _score("gray box fitted over 1 s, horizons, RMSE", None, "m", _HORIZON, role, "horizon", "rmse"),
        _score(
            "with viscous friction by direction, horizons, RMSE",
            None,
            "m",
            _DIRECTION,
            role,
            "horizon",
            "rmse",
        ),
    )


TABLES: tuple[ThesisTable, ...] = (
    ThesisTable(
        "6.2",
        "EMPS, estimates of the gray box",
        (
            Entry("M", 95.4520, "kg", ParameterOf(_FREE, "M")),
            Entry("f_v", 214.9261, "N·s/m", ParameterOf(_FREE, "carriage.viscous.f_v")),
            Entry("f_c", 19.3607, "N", ParameterOf(_FREE, "carriage.coulomb.f_c")),
            Entry("offset", -3.2902, "N", ParameterOf(_FREE, "carriage.offset.offset")),
            Entry("M, fitted over 1 s", None, "kg", ParameterOf(_HORIZON, "M")),
            Entry("f_v, fitted over 1 s", None, "N·s/m", ParameterOf(_HORIZON, "carriage.viscous.f_v")),
            Entry("f_c, fitted over 1 s", None, "N", ParameterOf(_HORIZON, "carriage.coulomb.f_c")),
            Entry("offset, fitted over 1 s", None, "N", ParameterOf(_HORIZON, "carriage.offset.offset")),
            Entry(
                "Fv− − Fv+, by direction",
                None,
                "N·s/m",
                ParameterOf(_DIRECTION, "carriage.asymmetric_viscous.df_v"),
            ),
        ),
        ("The thesis prints f_c in N·s/m; a Coulomb friction is a force, N.", _OPTIMUM),
    ),
    ThesisTable(
        "6.3", "EMPS, identification record", _scores("identification", 0.0049, 0.9965), (_RMSE, _HORIZONS)
    ),
    ThesisTable("6.4", "EMPS, validation record", _scores("validation", 0.0069, 0.9930), (_RMSE, _HORIZONS)),
)
