"""The commands that fit the model of a trace anew."""

from pathlib import Path

from hybridid.trace.entries import Width
from pipelines.shared.augmented import commands

NARROWED = (Width("carriage.epsilon", "m/s", 1e-3, 8.5e-05),)


def test_the_command_by_effects_says_how_sign_v_is_smoothed(settings):
    given = settings()
    by_file, by_effects = commands(given, Path("model.json"), 250, NARROWED)
    assert by_file.endswith(" model=model.json estimator.horizon=250"), "that file holds the width"
    assert " parameters.carriage.epsilon.guess=8.5e-05 estimator.horizon=250" in by_effects
    assert "epsilon" not in commands(given, Path("model.json"), 250)[1]


def test_the_commands_write_where_the_trace_wrote(settings):
    usual = commands(settings(), Path("model.json"), 250)
    assert all("paths.outputs" not in one for one in usual)
    given = settings({"paths": {"outputs": "/tmp/my results"}, "mlflow": {"enabled": False}})
    for one in commands(given, Path("model.json"), 250):
        assert "'paths.outputs=/tmp/my results' mlflow.enabled=false" in one
