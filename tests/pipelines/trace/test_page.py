"""The report of a stored trace: what it says of each entry, and where."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest

from hybridid.trace.entries import ReplacedEffect, TriedPair
from pipelines.shared.page import Picture, Section, Table
from pipelines.trace.figures import _tried
from pipelines.trace.page import trace_page


@pytest.fixture
def section(stored):
    """``section("What is left")`` of the page of a trace with the changes given."""

    def find(title: str, **changes) -> Section:
        sections = trace_page(stored(**changes), ()).sections
        return next(one for one in sections if one.title == title)

    return find


def column(table: Table, name: str) -> list[str]:
    return [row[table.header.index(name)] for row in table.rows]


def test_the_head_says_verdict_provenance_and_sentence(stored):
    page = trace_page(stored(), ())
    assert page.lead == "The model lacked a friction."
    assert page.points == ("Beware: it may be another one.", "Free runs say nothing.")
    assert page.marks == ("ambiguous", "simulated", "case cart")


def test_before_and_after_stand_side_by_side_with_the_change(section):
    (table,) = section("Before and after").tables
    assert column(table, "RMSE") == ["2 mm", "diverges", "1 mm", "500 µm", "1.2 mm", "600 µm"]
    assert column(table, "change") == ["", "", "", "−50.0 %", "", "−50.0 %"]
    assert table.caption == "Error of position before and after (simulated)"
    assert "data" not in table.header
    assert "Effects declared: cart.viscous; added: cart.coulomb." in table.notes[0]


def test_where_records_differ_each_row_says_what_its_data_are(section, stored):
    found = stored().found
    before, after = (
        tuple(replace(row, provenance="measured") if row.role == "held out" else row for row in rows)
        for rows in (found.before, found.after)
    )
    (table,) = section("Before and after", before=before, after=after).tables
    assert column(table, "data") == ["simulated"] * 4 + ["measured"] * 2


def test_of_many_records_the_means_come_first_and_each_is_folded_away(section, stored):
    found = stored().found
    before, after = (
        tuple(
            replace(row, record=f"{row.role} {k}", rmse=row.rmse * (1 + k * worse))
            for k in range(3)
            for row in rows
        )
        for rows, worse in ((found.before, 0), (found.after, 1))
    )
    means, each = section("Before and after", before=before, after=after).tables
    assert not means.folded
    assert column(means, "records") == ["3 fitted", "", "3 fitted", "", "3 held out", ""]
    assert column(means, "mean RMSE") == ["2 mm", "diverges", "1 mm", "1 mm", "1.2 mm", "1.2 mm"]
    assert column(means, "lower in") == ["", "0 of 3", "", "1 of 3", "", "1 of 3"]
    assert each.folded
    assert len(each.rows) == 18
    assert "Effects declared" in each.notes[0]


def test_nothing_accepted_shows_each_score_once(section):
    (table,) = section("Before and after", accepted=()).tables
    assert column(table, "RMSE") == ["2 mm", "1 mm", "1.2 mm"]
    assert "added: none" in table.notes[0]


def test_an_accepted_effect_shows_its_class_and_what_would_tell_it_apart(section):
    accepted = section("What was accepted")
    effects, survivals = accepted.tables
    assert column(effects, "cannot be told from") == ["dahl"]
    assert column(effects, "estimate ± 95 %") == ["f_c = 2.000 ± 0.098 N"]
    assert "To tell coulomb and dahl apart, record: slow reversals." in accepted.paragraphs
    outcomes = [row[-1] for row in survivals.rows]
    assert outcomes == ["", "survives", "lost", "refuted by the records", "too stiff to simulate"]


@pytest.mark.parametrize(("judging", "both"), [(12, True), (24, False)])
def test_the_rules_say_whether_both_sides_judge(section, judging, both):
    (table,) = section("How it was decided", horizons=(24, judging)).tables
    (said,) = (row[1] for row in table.rows if row[0] == "significant")
    assert said.endswith("cross-fitting decides") is both


def test_parameters_before_and_after(section):
    (table,) = section("Parameters").tables
    rows = {row[0]: row[1:] for row in table.rows}
    assert rows["M"] == ("10", "9 to 11", "9.5", "unknown (not identifiable)", "kg")
    assert rows["cart.coulomb.f_c"] == ("–", "", "2", "1.9 to 2.1 (at bound)", "N")


def test_of_a_model_that_the_trace_left_as_it_was_the_parameters_stand_once(section):
    (table,) = section("Parameters", accepted=()).tables
    assert table.header == ("parameter", "gray box", "95 % interval", "unit")
    assert table.rows[0] == ("M", "10", "9 to 11", "kg")


def test_refused_effects_keep_their_reason(section):
    (table,) = section("What was tried").tables
    assert column(table, "gain") == ["60.0 %", "diverges"]
    assert column(table, "adjusted p")[1] == "–", "what takes nothing has no p-value to show"
    assert set(column(table, "reason")) == {"its reason"}


def test_what_the_time_limit_left_untried_is_listed(section, stored):
    (step,) = stored().found.steps
    tried = section("What was tried", steps=(replace(step, left_out=("cart.dahl", "cart.lugre")),))
    assert tried.paragraphs[-1] == "The time limit left untried: cart.dahl and cart.lugre."


def test_a_trace_that_tried_no_effect_says_so(section, stored):
    (text,) = section("What was tried", steps=()).paragraphs
    assert text == f"No effect was tried: {stored().found.stopped}."


def test_pairs_that_were_tried_and_the_one_that_was_accepted(section, stored):
    names = ("cart.coulomb", "cart.offset")
    best = TriedPair(names, "passed", "each is needed", 0.4, 0.9, (0.8, 0.7), 1e-9, {}, 1.0)
    other = replace(best, effects=("cart.dahl", "cart.offset"), status="rejected", gains=(), gain=-1.0)
    (step,) = stored().found.steps
    step = replace(step, pairs=(best, other), family=741, together="cart.offset")
    tried = section("What was tried", steps=(step,))
    assert "ranked" in tried.paragraphs[1]
    table = tried.tables[1]
    assert table.caption == "Pairs tried: the 2 most promising of 741 (simulated)"
    assert column(table, "effects") == ["cart.coulomb and cart.offset", "cart.dahl and cart.offset"]
    assert column(table, "decision") == ["accepted", "rejected"]
    assert column(table, "of each beside the other") == ["80.0 %, 70.0 %", "–"]
    drawn = {one.name: one.status for one in _tried(step)}
    assert drawn["cart.coulomb + cart.offset"] == "accepted"
    assert drawn["cart.coulomb"] == "passed"  # its own trial: only the pair was accepted
    (entry,) = stored().found.accepted
    accepted = section("What was accepted", accepted=(replace(entry, together="cart.offset"),))
    assert "cart.coulomb was found only together with cart.offset" in accepted.paragraphs[1]


def test_of_the_laws_that_were_refused_the_best_are_told(section, stored):
    effect = stored().found.rejected[0]
    laws = tuple(replace(effect, effect=f"law_{k}", reason=f"p = {k}", is_law=True) for k in range(12))
    table = section("What was tried", refused_laws=laws, laws_formed=244).tables[-1]
    assert table.caption == (
        "Laws tried beside the last model: the best 10 of 12; none passes. All 244 that could be formed "
        "count (simulated)"
    )
    assert column(table, "law") == [f"law_{k}" for k in range(10)]
    assert column(table, "reason")[0] == "p = 0"


@pytest.mark.parametrize(
    ("gain", "p_value", "remains", "said"),
    [
        (0.3, 1e-9, ("at cart over velocity",), "Structure remains at cart over velocity"),
        (0.3, 1e-9, (), "do not keep that gain when the equations are solved another way"),
        (0.3, 0.5, (), "No learned effort is shown to take 5 % or more"),
        (0.01, 1e-9, (), "No learned effort is shown to take 5 % or more"),
    ],
)
def test_what_is_left(stored, section, gain, p_value, remains, said):
    """A learned effort counts if its gain is worth having and significant: the rule of the verdict."""
    found = stored().found
    after = tuple(replace(one, gain=gain, p_value=p_value) for one in found.ceilings.after)
    ceilings = replace(found.ceilings, after=after)
    assert said in section("What is left", ceilings=ceilings, remains=remains).paragraphs[1]


def test_a_learned_effort_that_only_learned_noise_takes_nothing(section):
    (table,) = section("What is left").tables
    assert column(table, "gray box") == ["50.0 %"]
    assert column(table, "gray box + effects") == ["none"]


def test_a_learned_effort_that_was_not_fitted_has_no_number(stored, section):
    found = stored().found
    after = tuple(replace(one, gain=0.0, ended_early=True, fitted=False) for one in found.ceilings.after)
    (table,) = section("What is left", ceilings=replace(found.ceilings, after=after)).tables
    assert column(table, "gray box + effects") == ["not fitted"]


def test_a_learned_effort_that_ended_early_says_so(stored, section):
    found = stored().found
    after = tuple(replace(one, gain=0.01, ended_early=True) for one in found.ceilings.after)
    (table,) = section("What is left", ceilings=replace(found.ceilings, after=after)).tables
    assert column(table, "gray box + effects") == ["1.0 % (ended early)"]


def test_without_effort_ports_there_is_no_network(stored):
    text = trace_page(stored(completeness=None), ()).markdown(Path())
    assert "Completeness check" not in text


def test_figures_stand_in_their_sections(stored, tmp_path):
    names = (
        "position.waterfall",
        "step1.trials",
        "a.position.error",
        "a.cart.missing_effort",
        "cart.ceiling",
    )
    for name in names:
        (tmp_path / f"{name}.svg").write_text("<svg/>")
    page = trace_page(stored(), [Picture(tmp_path / f"{name}.svg", name) for name in names])
    places = {picture.caption: one.title for one in page.sections for picture in one.pictures}
    assert places == {
        "position.waterfall": "Before and after",
        "step1.trials": "What was tried",
        "a.position.error": "The residual",
        "a.cart.missing_effort": "The residual",
        "cart.ceiling": "What is left",
    }


def test_text_of_the_library_is_escaped(stored):
    assert "&lt;against&gt;" in trace_page(stored(), ()).html()


def test_what_speaks_against_the_declared_physics_has_a_section(section, stored):
    pair = ("cart.coulomb", "cart.quadratic_drag")
    better = ReplacedEffect("cart.viscous", pair, "better", 0.28, 2e-5, -1, {}, {})
    as_good = ReplacedEffect("cart.offset", pair, "as_good", -0.004, 0.6, 3, {}, {})
    shown = section(
        "The declared physics",
        replacements=(better, as_good),
        idle=("cart.offset",),
        declared=("cart.viscous", "cart.offset"),
    )
    (table,) = shown.tables
    assert table.rows == (
        (
            "cart.viscous", "cart.coulomb and cart.quadratic_drag", "28.0 % less error", "2.00·10⁻⁵",
            "offset@cart, coulomb@cart, quadratic_drag@cart",
        ),
        (
            "cart.offset", "cart.coulomb and cart.quadratic_drag", "as good with 3 parameters fewer", "0.6",
            "viscous@cart, coulomb@cart, quadratic_drag@cart",
        ),
    )  # fmt: skip
    assert "do not tell cart.offset" in shown.paragraphs[0]
    titles = [one.title for one in trace_page(stored(), ()).sections]
    assert "The declared physics" not in titles


def test_the_next_commands_begin_with_values_of_its_own_where_recordings_disagree(stored):
    """Where nothing was accepted, no command fits the last model."""

    def next_commands(further_traces=(), **changes):
        commands = ("by=record", "model=", "effects=")
        made = replace(stored(**changes), commands=commands, further_traces=further_traces)
        return [one for one in trace_page(made, ()).sections if one.title == "Next commands"]

    (both,) = next_commands(own_values=("parameters.M.by=record",))
    assert both.commands == ("by=record", "model=", "effects=")
    assert both.paragraphs[0].startswith("The recordings disagree")
    (alone,) = next_commands(own_values=("parameters.M.by=record",), accepted=())
    assert alone.commands == ("by=record",)
    assert len(alone.paragraphs) == 1
    assert next_commands(accepted=()) == []
    (further,) = next_commands(("revise=true",), accepted=())
    assert (further.commands, len(further.paragraphs)) == (("revise=true",), 1)
