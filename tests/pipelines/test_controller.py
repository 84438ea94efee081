"""The section ``controller``: the view in the loop, beside free run and horizons, and when it is refused."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from hybridid.rigs.emps import EMPSRig
from hybridid_cli.results import summary
from pipelines.runner import run_stages
from pipelines.shared.errors import ConfigError
from pipelines.shared.predictions import agreements_in, metric_rows, predictions_in
from pipelines.validate import VALIDATE

LAW = {"law": "emps_pd", "parameters": {"gain": 35.15}}
REFERENCE = {"reference": {"column": "goal", "unit": "m"}}
PULSES = {"pulses": {"column": "volts", "unit": "V"}}
OWN = """
from hybridid.controllers.emps_pd import EMPSPD
LAW = EMPSPD()
FORCE = 3.0
"""


@pytest.fixture
def case(settings, own_folder):
    """The short case with references in its files."""
    folder = own_folder / "data"
    folder.mkdir(exist_ok=True)
    for name, run in (("first.csv", "identification"), ("second.csv", "validation")):
        record = EMPSRig().record(run, duration=1.2)
        columns = np.column_stack([record.time, record.inputs[:, 0], 1e3 * record.outputs, record.auxiliary])
        np.savetxt(
            folder / name, columns, delimiter=",", header="t,force,mm,goal,volts", comments="", fmt="%.16g"
        )

    def made(changes=None, **more):
        return settings({"controller": LAW, "validate.views": ["free_run", "loop"], "signals.auxiliary":
                         REFERENCE | PULSES} | (changes or {}), **more)  # fmt: skip

    return made


def rows_in(outcome, view="loop"):
    return {(r.record, r.output): r for r in metric_rows(outcome.tree) if r.view == view}


def test_outputs_and_effort_are_scored_in_the_loop(case, heard, fits_schema):
    outcome = run_stages(case(), "validate", heard)
    rows = rows_in(outcome)
    assert set(rows) == {(r, o) for r in ("first", "second") for o in ("position", "force")}
    assert all(row.rmse < 5e-6 for (_, output), row in rows.items() if output == "position")
    assert all(row.r2 > 0.99 and row.unit == "N" for (_, output), row in rows.items() if output == "force")
    assert all(law.agrees and law.share < 1e-6 for law in agreements_in(outcome.tree))
    assert heard.warned == []
    for name in ("law.json", "metrics.json"):
        fits_schema(outcome.tree / "validate" / name)
    loops = [s for s in predictions_in(outcome.tree) if s.prediction.view == "loop"]
    assert [s.prediction.output_names for s in loops] == [("position", "force")] * 2
    said = summary(outcome, "validate")
    assert "in the loop" in said
    assert "the law of emps_pd gives the recorded force within" in said


def test_the_other_views_do_not_move(case, heard):
    without = run_stages(case({"controller": None}), "validate", heard)
    before = rows_in(without, "free_run")
    assert rows_in(without) == {}
    assert agreements_in(without.tree) == []
    assert rows_in(run_stages(case(), "validate", heard), "free_run") == before


def test_another_law_is_refused_with_how_far_it_is(case, heard):
    outcome = run_stages(case({"controller": LAW | {"parameters": {"kp": 100.0}}}), "validate", heard)
    assert rows_in(outcome) == {}
    assert len(heard.warned) == 2
    assert heard.warned[0].startswith("not simulated in the loop: controller emps_pd is not the law that ran")
    assert agreements_in(outcome.tree)[0].remark in heard.warned[0]
    assert "too far apart: not simulated" in summary(outcome, "validate")
    assert not list((outcome.tree / "validate").glob("*.loop.parquet"))
    anew = run_stages(
        case({"controller": LAW | {"parameters": {"kp": 100.0}, "tolerance": 10.0}}), "validate", heard
    )
    assert anew.ran == ("validate",)
    assert all(np.isfinite(row.rmse) for row in rows_in(anew).values())


def test_a_record_without_the_reference_is_scored_in_the_other_views(case, heard):
    outcome = run_stages(case({"signals.auxiliary": PULSES}), "validate", heard)
    assert len(rows_in(outcome, "free_run")) == 2
    assert rows_in(outcome) == {}
    assert "in the loop (measured): not simulated: controller emps_pd: record" in summary(outcome, "validate")
    assert "record first has no signal reference, which is its reference" in heard.warned[0]


def test_pulses_are_zero_where_a_record_does_not_name_them(case, heard):
    """So the record with pulses is none that the law alone has run."""
    outcome = run_stages(case({"signals.auxiliary": REFERENCE}), "validate", heard)
    first, second = agreements_in(outcome.tree)
    assert (first.agrees, second.agrees) == (True, False)


def test_a_network_inside_the_equations_is_run_in_the_loop_too(case, heard):
    network = {
        "residual": {"kind": "rbf", "nodes": [2], "max_iterations": 3},
        "validate.records": ["first"],
    }
    outcome = run_stages(case(network), "validate", heard)
    models = {r.model for r in metric_rows(outcome.tree) if r.view == "loop"}
    assert models == {"gray box", "hybrid, RBF with 2 nodes"}


def test_the_figure_of_the_loop_is_its_own(case, heard, draw_only):
    draw_only("first.loop")
    outcome = run_stages(case({"plot": {"records": ["first"]}}), "plot", heard)
    drawn = {p.name for p in (outcome.tree / "plot").glob("*.svg")}
    assert (outcome.tree / "plot" / "first.loop.svg").stat().st_size > 10_000
    assert not any("force" in name for name in drawn)
    free = run_stages(case({"plot": {"records": ["first"]}, "controller": None}), "plot", heard)
    assert {p.name for p in (free.tree / "plot").glob("*.svg")} == drawn - {"first.loop.svg"}


def test_a_law_of_one_s_own_is_found_and_its_code_counts(case, heard, own_folder, nothing_imported):
    from pipelines.shared.own_code import make_importable

    (own_folder / "ownlaw.py").write_text(OWN)
    make_importable([own_folder])
    mine = case({"controller": "ownlaw:LAW"})
    assert mine["controller"] == {"law": "ownlaw:LAW"}
    assert run_stages(mine, "validate", heard).ran[-1] == "validate"
    assert run_stages(mine, "validate", heard).ran == ()
    assert "the code of ownlaw.py" in VALIDATE.inputs(mine)
    with pytest.raises(ConfigError, match="controller ownlaw:FORCE is a float, not a hybridid"):
        run_stages(case({"controller": "ownlaw:FORCE"}), "validate", heard)


@pytest.mark.parametrize(
    ("controller", "line"),
    [
        (
            "emps_pdd",
            "unknown controller 'emps_pdd': did you mean 'emps_pd'? allowed: emps_pd; your own is named",
        ),
        ({"law": "emps_pd", "parameters": {"kq": 1}}, "unknown parameter of controller emps_pd: 'kq'"),
        (
            {"law": "emps_pd", "references": {"goal": "goal"}},
            "unknown reference of controller emps_pd: 'goal'",
        ),
        ({"law": "emps_pd", "every": 0}, "controller.every is 0: at least 1"),
        ({"law": "emps_pd", "gains": {}}, "unknown config key below controller 'gains'"),
        ({"parameters": {"kp": 1}}, "controller.law is missing: expected text"),
        ({"law": "emps_pd", "tolerance": 0}, "controller.tolerance is 0"),
        (
            {"law": "emps_pd", "parameters": {"kp": "big"}},
            "controller.parameters: kp is 'big': expected a number",
        ),
    ],
)
def test_a_wrong_controller_is_refused_in_one_line(case, heard, own_folder, controller, line):
    with pytest.raises(ConfigError) as caught:
        run_stages(case({"controller": controller}), "validate", heard)
    assert str(caught.value).startswith(line)
    assert not (own_folder / "outputs").exists()


def test_the_case_of_the_measured_machine_names_its_law():
    """Its gains are those of the files, and of the authors."""
    import yaml

    case = yaml.safe_load((Path(__file__).parents[2] / "conf" / "case" / "emps.yaml").read_text())
    assert case["controller"]["law"] == "emps_pd"
    assert case["controller"]["parameters"] == {
        "kp": 160.18,
        "kv": 243.45,
        "gain": 35.15065188,
        "limit": 10.0,
    }
