"""Two arguments have one digest if they hold the same, in any process."""

from __future__ import annotations

import pickle
from dataclasses import dataclass, replace

import numpy as np
import pytest

from hybridid.effects.library import effect_named
from hybridid.trace.candidates import Candidate
from pipelines.shared.content_digest import LENGTH, content_digest


@dataclass(frozen=True)
class Found:
    values: dict[str, float]
    states: np.ndarray
    names: frozenset[str] = frozenset({"a", "b"})
    seconds: float = 1.0


FOUND = Found({"m": 1.0, "k": 2.0}, np.arange(6.0).reshape(2, 3))


def test_a_way_through_a_file_changes_nothing():
    shared = (FOUND, FOUND, FOUND.states)
    apart = tuple(pickle.loads(pickle.dumps(one)) for one in shared)
    assert pickle.dumps(shared) != pickle.dumps(apart)
    assert content_digest(shared) == content_digest(apart)
    assert len(content_digest(shared)) == LENGTH


def test_neither_the_order_of_keys_nor_the_seconds_count():
    again = replace(FOUND, values={"k": 2.0, "m": 1.0}, seconds=9.0)
    assert content_digest(again) == content_digest(FOUND)


@pytest.mark.parametrize(
    "other",
    [
        replace(FOUND, values={"m": 1.0, "k": 2.0 + 1e-15}),
        replace(FOUND, values={"m": 1.0}),
        replace(FOUND, states=FOUND.states.reshape(3, 2)),
        replace(FOUND, states=FOUND.states.astype(np.float32)),
        replace(FOUND, names=frozenset({"a"})),
        (FOUND,),
        "Found",
        None,
    ],
)
def test_what_holds_something_else_has_another_digest(other):
    assert content_digest(other) != content_digest(FOUND)


def test_what_is_grouped_in_another_way_has_another_digest():
    grouped = (((1,), 2), ((1, 2),), (1, 2), (1, (2,)), ({1: 2},))
    assert len({content_digest(each) for each in grouped}) == len(grouped)


def test_effects_differ_by_their_laws_and_numbers():
    one, other = (Candidate(effect_named(name), "carriage") for name in ("coulomb", "viscous"))
    finer = replace(one.effect, parameters=(replace(one.effect.parameters[0], guess=0.7),))
    digests = {content_digest(each) for each in (one, other, replace(one, effect=finer))}
    assert len(digests) == 3
