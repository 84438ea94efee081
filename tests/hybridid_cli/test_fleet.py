"""``hybridid trace -m``: a trace of each machine, and one table of all (simulated)."""

from __future__ import annotations

import csv
import json
from pathlib import Path

import pytest
from jsonschema import Draft202012Validator

from hybridid.records.sources import DataRoot
from hybridid_cli.file_globs import with_files
from pipelines.shared.errors import ConfigError

FEW = (
    "trace.effects=[asymmetric_viscous]",
    "trace.horizon=0.5",
    "trace.laws=false",
    "rig.duration=2.4",
    "trace.variables=[velocity]",
)


def test_one_table_of_all_machines_and_the_same_again(say, quick):
    asked = ("trace", "-m", *quick, *FEW, "effects=[viscous,coulomb,offset],[viscous,coulomb,offset,viscos]")
    said = say(*asked)
    assert said.code == 1, said.err
    assert "Machines (simulated)" in said.out
    assert "1 machine, effect found: 1." in said.out
    assert "What they lack: carriage.asymmetric_viscous: 1 of 1." in said.out
    assert "1 of 2 points have no result: effects=[viscous,coulomb,offset,viscos]" in said.complaint
    assert "did you mean 'viscous'?" in said.complaint
    (folder,) = Path("outputs/sweeps").iterdir()
    assert folder.name.endswith("-simulated")
    data = json.loads((folder / "fleet.json").read_text())
    schema = Path(__file__).parents[2] / "docs/schemas/fleet.schema.json"
    Draft202012Validator(json.loads(schema.read_text())).validate(data)
    (machine,) = data["machines"]
    assert machine["verdict"] == "effect_found"
    assert machine["after"]["position"] < machine["before"]["position"]
    assert (folder / machine["tree"] / "trace/report.html").exists()
    (row,) = csv.DictReader((folder / "fleet.csv").open())
    assert float(row["held_out_rmse_after"]) == machine["after"]["position"]
    assert row["provenance"] == "simulated"
    assert "hybridid trace -m" in (folder / "index.md").read_text()

    again = say(*asked)
    assert "1 of them fresh, 0 to do" in again.err
    assert json.loads((folder / "fleet.json").read_text())["machines"] == [machine]


@pytest.fixture
def runs(tmp_path):
    for name in ("b.csv", "a, 1.csv", "o'clock.csv", "notes.txt"):
        (tmp_path / "runs" / name).parent.mkdir(exist_ok=True)
        (tmp_path / "runs" / name).touch()
    return [DataRoot(tmp_path / "empty"), DataRoot(tmp_path)]


def test_a_pattern_becomes_the_files_that_it_finds(runs):
    word, other = with_files(["records.r.files=glob(runs/*.csv)", "estimator.horizon=1,2"], runs)
    assert word == r"records.r.files=choice('runs/a, 1.csv','runs/b.csv','runs/o\'clock.csv')"
    assert other == "estimator.horizon=1,2"


def test_hydra_reads_these_names_back(runs):
    from hydra.core.override_parser.overrides_parser import OverridesParser

    (word,) = with_files(["records.r.files=glob(runs/*.csv)"], runs)
    found = OverridesParser.create().parse_override(word)
    values = [str(getattr(value, "text", value)) for value in found.value().list]
    assert values == ["runs/a, 1.csv", "runs/b.csv", "runs/o'clock.csv"]


def test_a_pattern_without_a_file_names_the_folders(runs):
    with pytest.raises(ConfigError, match=r"glob\(\*\.mat\): no file matches this pattern; searched .*empty"):
        with_files(["records.r.files=glob(*.mat)"], runs)
