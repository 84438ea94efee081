"""Received files: some are really opened, and a decoy that runs is seen."""

from __future__ import annotations

import sys
from dataclasses import replace

import pytest

from benchmarks.torture import archives, poisoned, received
from benchmarks.torture.bench import RAN, WRONG

pytestmark = pytest.mark.skipif(sys.platform != "linux", reason="each trial has a process that is forked")


@pytest.fixture(scope="module")
def bench(tmp_path_factory):
    return tmp_path_factory.mktemp("bench")


def opened(name, command):
    """The trial of a trap under a command."""
    (found,) = (
        one
        for one in received.trials(20)
        if isinstance(one, received.Opened) and one.trap.name == name and one.words[0] == command
    )
    return found


SOME = (
    ("a plant in its folder", "fit"),
    ("a part of a package", "validate"),
    ("os:system as a plant", "trace"),
    ("trusted, then changed by a byte", "fit"),
    ("control: trusted", "fit"),
    ("control: named by --config-dir", "fit"),
    ("a pickle that says it is .mat", "fit"),
)


@pytest.mark.parametrize(("name", "command"), SOME)
def test_what_is_received_does_not_run(bench, name, command):
    assert opened(name, command).carried_out(bench).faults == ()


def test_code_that_runs_is_seen(bench):
    """As the control, which the user trusts, is not to be believed."""
    trial = opened("control: trusted", "fit")
    seen = replace(trial, trap=replace(trial.trap, runs=False)).carried_out(bench)
    assert RAN in {fault.kind for fault in seen.faults}
    sound = opened("a plant in its folder", "fit")
    seen = replace(sound, trap=replace(sound.trap, runs=True)).carried_out(bench)
    assert {fault.kind for fault in seen.faults} == {WRONG}


@pytest.mark.parametrize("name", ["a member ../evil", "an endless reply"])
def test_archives_that_are_not_the_published_one_leave_nothing(bench, name):
    (trial,) = (one for one in archives.trials(20) if one.name == name)
    assert trial.carried_out(bench).faults == ()


def test_code_in_the_cache_is_not_loaded(bench):
    name = "with the seal of another"
    (trial,) = (one for one in poisoned.trials(20) if (one.what, one.name) == ("compiled models", name))
    assert trial.carried_out(bench).faults == ()


def test_each_kind_of_received_file_has_a_control():
    keys = [trial.key for trial in received.trials(20)]
    assert len(set(keys)) == len(keys) >= 500
    for what in ("model files, control", "compiled models, control", "unfinished results, control"):
        assert any(what in key for key in keys)
