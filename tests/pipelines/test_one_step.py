"""Records with different steps end a command before its fit, with the key that makes them alike."""

from __future__ import annotations

import numpy as np
import pytest

from pipelines.runner import run_stages
from pipelines.shared.errors import ConfigError


@pytest.fixture
def uneven(settings, own_folder):
    """The short case with its first recording at 100 Hz and its second at 50 Hz."""
    folder = own_folder / "data"
    folder.mkdir()
    for name, step in (("first.csv", 0.01), ("second.csv", 0.02)):
        time = step * np.arange(600)
        columns = np.column_stack([time, np.sin(9 * time), np.cos(9 * time)])
        np.savetxt(folder / name, columns, delimiter=",", header="t,force,mm", comments="")
    return settings


@pytest.mark.parametrize(
    ("command", "changes"),
    [("fit", {"fit.records": None}), ("trace", {"validate.horizon": 0.5})],
)
def test_the_key_and_its_value_are_named(uneven, heard, command, changes):
    with pytest.raises(ConfigError) as caught:
        run_stages(uneven(changes), command, heard)
    assert str(caught.value) == (
        "records differ in sampling time: second (0.02 s) from first (0.01 s); "
        "set records.second.resample=0.01"
    )
    assert not any(line.startswith("fit") for line in heard.said)


def test_a_record_that_only_validates_may_have_a_step_of_its_own(uneven, heard):
    found = run_stages(uneven({"validate.horizon": 0.5, "validate.views": ["horizon"]}), "validate", heard)
    assert "validate" in found.ran


def test_the_key_does_it(uneven, heard):
    alike = uneven({"fit.records": None, "records.second.resample": 0.01})
    assert "fit" in run_stages(alike, "fit", heard).ran
