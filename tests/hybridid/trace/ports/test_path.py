"""What a path shows of a port: its load, and the deflection of a bristle that it drags along."""

from __future__ import annotations

import numpy as np
import pytest

from hybridid.effects.over import BRISTLE, RECENT_LOAD, Over
from hybridid.trace.ports.path import Path, _deflection
from hybridid.trace.refits.refit import refit


@pytest.fixture(scope="module")
def path(make_model, split_of):
    split = split_of()
    return Path.of(refit(make_model(), split), split, split.fitted)


def test_the_load_of_a_carriage_is_the_force_of_its_drive(path):
    assert path.motion("carriage", "load") == pytest.approx(path.inputs[:, 0])


def test_a_port_without_a_load_shows_no_learned_effort_over_it(path):
    assert path.shows("carriage", Over("load", "sign of velocity"))
    assert Over("load").needs == ("load",)
    assert Over("position", "acceleration").needs == ()


def test_a_bristle_deflects_to_its_largest_and_comes_back(path):
    length = 0.01
    way = np.concatenate([np.linspace(0, 0.1, 50), np.linspace(0.1, 0.09, 20)])
    found = _deflection(way, length)
    assert found[49] == pytest.approx(1 - np.exp(-0.1 / length))
    assert found[-1] == pytest.approx(-1 + (found[49] + 1) * np.exp(-0.01 / length))
    assert np.abs(path.motion("carriage", BRISTLE)).max() <= 1


def test_a_recent_load_is_a_lag_of_the_load_and_a_learned_effort_covers_it_up_to_the_load(path):
    over, load = Over(RECENT_LOAD, "sign of velocity"), np.abs(path.motion("carriage", "load"))
    seen, covered = path.seen("carriage", over), path.covered("carriage", over)
    share = np.median(np.diff(path.time)) / path.memory("carriage", RECENT_LOAD)
    assert seen[1:] == pytest.approx(seen[:-1] + share * (load[1:] - seen[:-1]))
    assert seen.max() < 0.9 * load.max() == 0.9 * covered.max()
    assert (path.covered("carriage", Over("velocity")) == path.seen("carriage", Over("velocity"))).all()
