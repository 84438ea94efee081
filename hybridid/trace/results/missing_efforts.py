"""The missing efforts of several models at every port on every record."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from hybridid.declarations import PortKind
from hybridid.naming import listed
from hybridid.records.record import Record
from hybridid.simulation.stability import MOST, TooStiff
from hybridid.trace.context import Context
from hybridid.trace.ports.missing_effort import MissingEffort, missing_effort
from hybridid.trace.results.before_after import FittedModel

Missing = Mapping[tuple[str, str], Mapping[str, MissingEffort]]
"""Missing efforts by record and port; within, by model."""


@dataclass(frozen=True)
class Failure:
    """Why an effort or flow (``kind``) could not be estimated."""

    kind: PortKind
    place: str
    what: str


def in_words(failures: Sequence[Failure]) -> tuple[str, ...]:
    """What could not be estimated and why: the places that fail alike in one line."""
    places: dict[tuple[PortKind, str], list[str]] = {}
    for one in failures:
        places.setdefault((one.kind, one.what), []).append(one.place)
    return tuple(f"missing {kind} at {listed(at)}: {what}" for (kind, what), at in places.items())


def missing_efforts(
    models: Sequence[FittedModel], records: Sequence[Record], context: Context
) -> tuple[Missing, tuple[str, ...]]:
    """What each of ``models`` lacks at each effort or flow port on every record, and in words what failed."""
    ports = [port.name for port in context.equation_ports(models[0].model)]
    places = [(one, record, port) for record in records for port in ports for one in models]
    results = context.each("missing effort", _attempt, places, _place)
    found: dict[tuple[str, str], dict[str, MissingEffort]] = {}
    for (one, record, port), result in zip(places, results, strict=True):
        if isinstance(result, MissingEffort):
            found.setdefault((record.name, port), {})[one.name] = result
    return found, in_words([result for result in results if isinstance(result, Failure)])


def _attempt(one: FittedModel, record: Record, port: str) -> MissingEffort | Failure:
    kind, place = one.model.plant.port(port).kind, f"{port} on {record.name}, {one.name}"
    try:
        return missing_effort(one.model, one.estimate.values, record, port)
    except TooStiff:  # another integrator does not help here
        return Failure(
            kind, place, f"it is estimated with RK4, and the model needs more than {MOST} steps a sample"
        )
    except (ValueError, ArithmeticError, np.linalg.LinAlgError) as error:
        return Failure(kind, place, str(error))


def _place(result: MissingEffort | Failure) -> str:
    return result.place if isinstance(result, Failure) else f"{result.record}, {result.port}"
