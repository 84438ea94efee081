"""Every entry of every table finds its number in the run trees, or says why there is none."""

from __future__ import annotations

import json

import pytest

from hybridid.quantities import estimated
from pipelines.thesis import look_up
from pipelines.thesis.choice import choices
from pipelines.thesis.look_up import Failed, Missing
from pipelines.thesis.page import CHAPTERS
from pipelines.thesis.reference import EveryEstimate, NetworkOf, ScoreOf, ScoreTable, experiments_of
from pipelines.thesis.tables import ILLEGIBLE, NONE, table_of

TABLES = [table for chapter in CHAPTERS for table in chapter.tables]
SCORES = [table for table in TABLES if isinstance(table, ScoreTable)]
ESTIMATES = [table for table in TABLES if not isinstance(table, ScoreTable)]


def provenance(experiment):
    return "measured" if experiment.startswith("emps") else "simulated"


def parameter_of(tree, where):
    return json.loads((tree / "fit/estimate.json").read_text())["parameters"][where.name]["value"]


def the(number, title=""):
    return next(t for t in TABLES if t.number == number and title in t.title)


def rewrite(path, change):
    content = json.loads(path.read_text())
    change(content)
    path.write_text(json.dumps(content))


def test_no_two_scores_of_the_thesis_share_one_of_ours(trees):
    """Each row finds a number of its own: no role, output, view or model is mixed up with another."""
    for table in SCORES:
        found = [look_up.score(row.ours, trees).rmse for row in table.rows]
        assert len(set(found)) == len(found)


@pytest.mark.parametrize("of", SCORES, ids=lambda t: t.title)
def test_every_row_of_scores_shows_ours_beside_the_thesis(trees, of):
    table = table_of(of, trees)
    errors = [column for column, name in enumerate(table.header) if "MSE" in name or name == "ours"]
    ours = errors[1] if "thesis" in table.header[errors[0]] else errors[0]
    for row, shown in zip(of.rows, table.rows, strict=True):
        found = look_up.score(row.ours, trees)
        value = found.mse if of.measure == "mse" else found.rmse
        assert float(shown[ours]) == pytest.approx(value * of.factor, rel=1e-3)
        assert shown[-1] == provenance(row.ours.experiment)
        if row.thesis is not None:
            assert shown[1] == f"{row.thesis.error:.4f}"


@pytest.mark.parametrize("of", ESTIMATES, ids=lambda t: t.title)
def test_every_row_of_estimates_shows_ours_beside_the_thesis(trees, of):
    shown = {row[0]: row for row in table_of(of, trees).rows}
    for row in of.rows:
        if isinstance(row, EveryEstimate):
            cells = shown[f"{row.label}: viscous.f_v"]
            assert cells[1] == ILLEGIBLE
        else:
            cells = shown[row.label]
            value = parameter_of(trees[row.ours.experiment], row.ours)
            assert cells[1] == (NONE if row.thesis is None else cells[1])
            assert cells[2] == estimated(value, 0.5, "")
        assert cells[-1] == provenance(next(iter(experiments_of(of))))


def test_the_hybrid_and_the_gray_box_have_rows_of_their_own(trees):
    where = ScoreOf("esea_dahl", "validation", "link_velocity")
    hybrid = ScoreOf("esea_dahl", "validation", "link_velocity", "hybrid")
    rows = json.loads((trees["esea_dahl"] / "validate/metrics.json").read_text())
    by_model = {r["model"]: r["rmse"] for r in rows if (r["record"], r["view"]) == ("validation", "free_run")}
    assert look_up.score(where, trees).rmse == by_model["gray box"]
    assert look_up.score(hybrid, trees).rmse == by_model["hybrid, a network"]


def test_of_several_seeds_the_one_with_the_lower_held_out_error_counts(trees):
    found = look_up.score(NetworkOf("vehicle_narx", "validation", "pitch_rate", 4, 16), trees)
    networks = json.loads((trees["vehicle_narx"] / "residual/residual.json").read_text())["networks"]
    own = [n for n in networks if (n["output"], n["depth"], n["width"]) == ("pitch_rate", 4, 16)]
    held_out = {n["seed"]: n["hybrid"][1]["rmse"] for n in own}
    assert found.rmse == held_out[1] != held_out[0]


def test_reductions_are_against_the_row_that_the_thesis_compares_with(trees):
    table = table_of(the("5.5"), trees)
    gray = look_up.score(ScoreOf("esea_dahl", "validation", "link_velocity"), trees)
    hybrid = look_up.score(ScoreOf("esea_dahl", "validation", "link_velocity", "hybrid"), trees)
    row = next(row for row in table.rows if row[0] == "Dahl, hybrid")
    assert row[5] == "−27.2 %"
    assert row[6] == f"{100 * (1 - hybrid.mse / gray.mse):.1f} %".replace("-", "−")


def test_the_pattern_and_the_errata_stand_below_their_table(trees):
    notes = table_of(the("5.5"), trees).notes
    assert notes[0].startswith("Improve most, thesis: linear 61.3 %, Coulomb and Stribeck 15.1 %, LuGre 5")
    assert "Ours (simulated): " in notes[0]
    assert "Worse than their gray box: Dahl in the thesis" in notes[1]
    assert notes[2:] == the("5.5").care


def test_what_a_reader_must_know_of_an_estimate_stands_beside_it(trees):
    path = trees["vehicle_narx"] / "fit/estimate.json"
    rewrite(path, lambda content: content["parameters"]["k_t"].update(at_bound=True, std=None))
    rewrite(path, lambda content: content.update(converged=False))
    shown = {row[0]: row[2] for row in table_of(the("4.2"), trees).rows}
    assert shown["k_t"].endswith("(at its bound, fit not converged)")
    assert "± ?" in shown["k_t"]


def test_a_failed_experiment_says_why_in_its_rows_and_keeps_the_others(trees):
    outcomes = {**trees, "esea_dahl": Failed("no memory left")}
    rows = {row[0]: row for row in table_of(the("5.4"), outcomes).rows}
    assert rows["Dahl"][2] == rows["Dahl, hybrid"][2] == "failed: no memory left"
    assert rows["Dahl"][1] == "4.1782"  # the thesis' number stays
    assert float(rows["LuGre"][2]) > 0


def test_an_experiment_that_nobody_asked_for_says_so(trees):
    del trees["emps_rbf_32"]
    rows = {row[0]: row for row in table_of(the("6.3"), trees).rows}
    assert rows["hybrid, 32 nodes"][2] == "not run"


def test_a_model_that_diverged_says_so(trees):
    def diverge(rows):
        for row in rows:
            row.update(rmse=None, mse=None, r2=None, remark="left its guard")

    rewrite(trees["esea_lugre"] / "validate/metrics.json", diverge)
    with pytest.raises(Missing, match="diverged: left its guard"):
        look_up.score(ScoreOf("esea_lugre", "validation", "link_velocity", "hybrid"), trees)


def test_without_a_validation_record_there_is_no_number(trees):
    rewrite(trees["emps_rbf_4"] / "preprocess/records.json", lambda rows: rows.pop())
    with pytest.raises(Missing, match="no such record"):
        look_up.score(ScoreOf("emps_rbf_4", "validation", "position"), trees)


def test_the_choices_are_told_with_their_rule(trees):
    (nodes,) = choices(6, trees)
    assert nodes.startswith("Nodes chosen without the validation record: 8, by the rule: the smallest. ")
    assert "gray box 2 mm, 4 nodes 1.04 mm, 8 nodes 1.08 mm" in nodes
    assert "32 nodes failed (a simulation diverges)" in nodes
    velocity, pitch, rule = choices(4, trees)
    assert velocity.startswith("Table 4.4: chosen here 3 × 8; the thesis chose 4 × 16")
    assert pitch.startswith("Table 4.5: chosen here 3 × 8; the thesis chose 3 × 16")
    assert rule == "Our rule uses the identification record alone: the smallest."
    (joint,) = choices(5, trees)
    assert "linear 3 × 8, Coulomb and Stribeck 3 × 8, Dahl 3 × 8, LuGre 3 × 8" in joint


def test_without_results_nothing_is_said_of_choices():
    assert [choices(chapter, {"vehicle_narx": Failed("no")}) for chapter in (4, 5, 6)] == [(), (), ()]
