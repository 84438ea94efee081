"""The measured league, played on a short record of a virtual rig."""

from __future__ import annotations

import math
from dataclasses import replace
from types import SimpleNamespace

import pytest

from benchmarks.measured import __main__ as command
from benchmarks.measured.entry import Asked, asked_of, entries, every
from benchmarks.measured.play import Outcome, named, words
from benchmarks.measured.report import write_report
from pipelines.shared.errors import ConfigError

ENTRY = """
title: the virtual rig of EMPS
case: emps
data: simulated
options:
- rig.duration=4.0
- trace.effects=[asymmetric_viscous]
- trace.laws=false
- trace.variables=[velocity]
declared: [viscous@carriage]
lacks: [asymmetric_viscous]
judge: {records: [validation], output: position}
published: {physics: the rig's own, error: 1.0e-3, of: a number of this test, source: nobody}
"""


@pytest.fixture
def folder(tmp_path):
    (tmp_path / "rig").mkdir()
    (tmp_path / "rig" / "entry.yaml").write_text(ENTRY)
    return tmp_path


def test_every_entry_of_the_league_is_sound():
    found = entries()
    assert {"emps", "silverbox", "flexible_link", "servo"} <= {entry.name for entry in found}
    for asked in every(found):
        assert set(asked.effects) | {asked.left_out} - {""} == set(asked.entry.declared)
        assert asked.entry.data == "measured"


def test_each_declared_effect_is_left_out_in_turn():
    (emps,) = (entry for entry in entries() if entry.name == "emps")
    labels = [asked.label for asked in asked_of(emps)]
    assert labels == ["declared", "without viscous", "without coulomb", "without offset"]
    assert asked_of(emps)[1].wanted == ("viscous",)
    assert asked_of(emps)[0].wanted == ("asymmetric_viscous",)
    assert "effects=[coulomb@carriage,offset@carriage]" in words(asked_of(emps)[1])


def test_a_wrong_key_is_named(folder):
    (folder / "rig" / "entry.yaml").write_text(ENTRY.replace("lacks", "laks"))
    with pytest.raises(ConfigError, match=r"entry\.yaml: unknown key 'laks': did you mean 'lacks'"):
        entries(folder)


def test_the_league_on_a_rig(folder, monkeypatch, capsys):
    monkeypatch.setenv("OMP_NUM_THREADS", "1")
    out = folder / "out"
    assert command.main(["--entries", str(folder), "--out", str(out), "--match", "declared"]) == 0
    said = capsys.readouterr().out
    assert said.startswith("rig/declared (simulated): ")
    page = (out / "index.md").read_text()
    assert "rig's own" in page
    assert "(simulated)" in page
    assert "1 mm" in page


def test_what_cannot_be_traced_is_told(folder, capsys):
    (folder / "rig" / "entry.yaml").write_text(ENTRY.replace("viscous@carriage", "nonsense@carriage"))
    assert command.main(["--entries", str(folder), "--out", str(folder), "--match", "declared"]) == 1
    assert "unknown effect 'nonsense'" in capsys.readouterr().out
    assert "unknown effect 'nonsense'" in (folder / "index.md").read_text()


def _outcome(*accepted, wanted="asymmetric_viscous"):
    (entry,) = (one for one in entries() if one.name == "emps")
    asked = Asked(replace(entry, lacks=(wanted,)))
    runs = (
        ("free_run", "validation", 3.0),
        ("free_run", "identification", 9.0),
        ("horizon", "validation", 7.0),
    )
    common = {"output": "position", "network": False, "role": "held out"}
    rows = [SimpleNamespace(view=view, record=record, rmse=rmse, **common) for view, record, rmse in runs]
    return Outcome(asked, SimpleNamespace(accepted=accepted, before=rows, after=rows))


def _accepted(effect, *others):
    return SimpleNamespace(effect=effect, alike=(effect, *others), others=others, name=f"carriage.{effect}")


def test_where_the_known_effect_stands():
    drag, wanted = _accepted("quadratic_drag"), _accepted("asymmetric_viscous")
    assert _outcome(wanted, drag).hit == "first"
    assert _outcome(drag, wanted).hit == "later"
    assert _outcome(_accepted("quadratic_drag", "asymmetric_viscous")).hit == "in the class of quadratic_drag"
    assert _outcome(drag).hit == "no"
    assert named(_accepted("a", "b", "c")) == "carriage.a (or b, c)"


def test_the_judge_s_free_run_is_that_of_its_records():
    assert _outcome().free_run == (3.0, 3.0)
    one = _outcome()
    entry = replace(one.asked.entry, judge=replace(one.asked.entry.judge, records=None))
    assert replace(one, asked=Asked(entry)).free_run == (6.0, 6.0)
    nowhere = replace(entry, judge=replace(entry.judge, records=("none",)))
    assert math.isnan(replace(one, asked=Asked(nowhere)).free_run[0])


def test_a_league_without_results_has_a_page(tmp_path):
    (entry, *_) = entries()
    told = write_report([Outcome(Asked(entry), failure="no such file")], tmp_path, 60.0)
    assert f"{entry.name}/declared: no such file" in told
    assert "Of 0 traces" in (tmp_path / "index.md").read_text()
