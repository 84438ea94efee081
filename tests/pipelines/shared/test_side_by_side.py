"""Traces with different options lie side by side, and ``trace`` leads to the one asked for last."""

from __future__ import annotations

from pathlib import Path

import pytest

from pipelines import runner
from pipelines.runner import is_fresh, run_stages
from pipelines.shared import freshness, side_by_side
from pipelines.tracking.facts import artifacts_of

TREE = Path("tree")
LINK = TREE / "trace"
SHORT, LONG = {"trace.horizon": 0.1}, {"trace.horizon": 0.2}


@pytest.fixture
def trace(settings, heard, data):
    """``trace(SHORT)`` runs the command with a stage that only writes its horizon, and says what it did."""

    def run(options, function=None):
        heard.said.clear()
        asked = settings({"out": "tree", **options})
        return run_stages(asked, "trace", heard, instead={"trace": function or _write_the_horizon})

    return run


def _write_the_horizon(job):
    (job.folder / "horizon").write_text(str(job.settings["trace.horizon"]))


def horizon(folder=LINK) -> str:
    return (folder / "horizon").read_text()


def test_two_lie_side_by_side_and_going_back_is_fresh(trace, heard):
    first = trace(SHORT)
    assert "earlier" not in " ".join(heard.said)
    second = trace(LONG)
    assert (first.ran[-1], second.ran) == ("trace", ("trace",))
    assert [horizon(one.folders["trace"]) for one in (first, second)] == ["0.1", "0.2"]
    assert horizon() == "0.2"
    where = first.folders["trace"]
    assert heard.said[-1] == f"trace: an earlier result, with trace.horizon=0.1, is kept in {where}"
    assert trace(SHORT).ran == ()
    assert "trace: fresh, reused" in heard.said
    assert horizon() == "0.1"
    assert not LINK.readlink().is_absolute()  # so that the tree can be moved


def test_the_number_of_processes_is_no_option(trace):
    """It moves no number: a trace by one process is that by two."""
    trace({**SHORT, "trace.processes": 1})
    assert trace({**SHORT, "trace.processes": 2}).ran == ()


def test_the_line_names_the_newest_and_counts_the_others(trace, heard):
    for options in (SHORT, LONG, {"trace.horizon": 0.3, "trace.worth": 0.1, "trace.effects": ["dahl"]}):
        newest = trace(options).folders["trace"]
    trace({"trace.horizon": 0.4})
    assert heard.said[-1] == (
        "trace: an earlier result, with trace.effects=[dahl], trace.horizon=0.3 and 1 other option, is kept "
        f"in {newest}; 2 more lie beside it"
    )


def test_each_is_stale_by_its_own_code_and_inputs(trace, heard, settings, monkeypatch):
    trace(SHORT), trace(LONG)
    assert is_fresh(settings({"out": "tree", **SHORT}), "trace", TREE)
    code = freshness.code_of

    def changed(module):
        return {**code(module), **({"hybridid.trace": "other"} if module == "pipelines.trace" else {})}

    monkeypatch.setattr(freshness, "code_of", changed)
    assert not is_fresh(settings({"out": "tree", **SHORT}), "trace", TREE)
    trace(SHORT)
    assert "trace: stale, the code of hybridid.trace changed" in heard.said


def test_a_changed_fit_removes_them_all(trace, heard, settings):
    trace(SHORT), trace(LONG)
    run_stages(settings({"out": "tree", "effects": ["viscous"]}), "fit", heard)
    assert "trace: removed" in heard.said[-1]
    assert sorted(p.name for p in TREE.iterdir() if p.name != ".lock") == ["config.yaml", "fit", "preprocess"]


def test_one_that_follows_a_changed_fit_says_that_the_others_are_gone(trace, heard):
    trace(SHORT), trace(LONG)
    trace({**SHORT, "effects": ["viscous"]})
    assert heard.said[-1] == "trace: 2 earlier results removed, made from results that have changed"
    assert horizon() == "0.1"


def test_an_interrupted_one_leaves_the_earlier(trace):
    trace(SHORT)

    def interrupted(job):
        _write_the_horizon(job)
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        trace(LONG, interrupted)
    assert horizon() == "0.1"
    assert len(list((TREE / "traces").iterdir())) == 1
    assert trace(LONG).ran == ("trace",)


def test_killed_after_it_is_written_it_is_not_made_again(trace, monkeypatch):
    trace(SHORT)

    def killed_at_the_trace(stage, *more):
        if stage.name == "trace":
            raise SystemExit

    with monkeypatch.context() as patched:
        patched.setattr(runner, "show_newest", killed_at_the_trace)
        with pytest.raises(SystemExit):
            trace(LONG)
    assert horizon() == "0.1"
    assert trace(LONG).ran == ()
    assert horizon() == "0.2"


def test_a_link_that_leads_nowhere_is_put_right(trace):
    folder = trace(SHORT).folders["trace"]
    LINK.unlink()
    LINK.symlink_to("traces/gone")
    (TREE / ".trace-link").symlink_to("traces/gone")  # of a command that was killed
    assert trace(SHORT).ran == ()
    assert LINK.resolve() == folder.resolve()


def test_left_overs_of_a_killed_removal_are_removed(trace):
    trace(SHORT)
    (TREE / "traces/.replaced-x").mkdir()
    trace(SHORT)
    assert not (TREE / "traces/.replaced-x").exists()


def test_a_folder_of_an_earlier_version_becomes_one_of_them(trace, heard):
    folder = trace(SHORT).folders["trace"]
    LINK.unlink()
    folder.rename(LINK)
    trace(LONG)
    assert heard.said[-1].endswith(f"with trace.horizon=0.1, is kept in {folder}")
    assert trace(SHORT).ran == ()


def test_a_folder_without_a_receipt_is_replaced(trace):
    folder = trace(SHORT).folders["trace"]
    LINK.unlink()
    folder.rename(LINK)
    (LINK / "stage.json").unlink()
    assert trace(SHORT).ran == ("trace",)
    assert horizon() == "0.1"


def test_mlflow_keeps_the_files_of_this_one_whatever_the_link_says_later(trace):
    first = trace(SHORT)
    trace(LONG)
    (kept,) = [a for a in artifacts_of(first) if a.into == "trace"]
    assert horizon(kept.source) == "0.1"


def test_words_of_one_more(tmp_path):
    kept = side_by_side.Kept(tmp_path, {"trace.laws": False})
    assert side_by_side.in_words([kept, kept]).endswith(
        f"with trace.laws=false, is kept in {tmp_path}; 1 more lies beside it"
    )
