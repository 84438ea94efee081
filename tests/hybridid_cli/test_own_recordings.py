"""The recordings of the eSEA and of the vehicle, dropped in as files: the same command takes them."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from hybridid.records.record import Record
from hybridid.rigs.esea import ESEARig
from hybridid.rigs.half_car import HalfCarRig

CASES = {
    "esea": (ESEARig(), {"identification": "identification", "validation": "validation"}),
    "vehicle": (HalfCarRig(), {"bump_20kmh": "identification", "bump_15kmh": "validation"}),
}


def write(path: Path, record: Record) -> None:
    """Time, inputs and outputs under their names, as a logger would."""
    channels = [*record.input_channels, *record.output_channels]
    columns = np.column_stack([record.time, record.inputs, record.outputs])
    header = ",".join(["time", *(channel.name for channel in channels)])
    path.parent.mkdir(parents=True, exist_ok=True)
    np.savetxt(path, columns, delimiter=",", header=header, comments="")


@pytest.mark.parametrize("case", CASES)
def test_a_recording_dropped_in_is_taken_and_called_measured(say, own_folder, monkeypatch, case):
    rig, files = CASES[case]
    for name, run in files.items():
        write(own_folder / "mine" / case / f"{name}.csv", rig.record(run))
    monkeypatch.setenv("HYBRIDID_DATA", str(own_folder / "mine"))
    said = say("validate", f"case={case}", "mlflow.enabled=false", f"out={own_folder / 'tree'}")
    assert said.code == 0, said.err
    assert "simulated" not in said.out + said.err
    rows = json.loads((own_folder / "tree/validate/metrics.json").read_text())
    assert {row["provenance"] for row in rows} == {"measured"}
    assert {row["record"] for row in rows} == {"identification", "validation"}
    assert all(row["r2"] > 0.6 for row in rows), rows


def test_half_of_a_pair_is_not_filled_up_from_the_rig(say, own_folder, monkeypatch):
    write(own_folder / "mine/esea/identification.csv", ESEARig().record(duration=1.0))
    monkeypatch.setenv("HYBRIDID_DATA", str(own_folder / "mine"))
    said = say("fit", "case=esea", "data=measured", "mlflow.enabled=false", f"out={own_folder / 'tree'}")
    assert said.code != 0
    assert "esea/validation.csv" in said.complaint
