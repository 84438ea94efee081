"""The commands that fit the model of a trace anew."""

from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

from hybridid.trace.entries import Width
from hybridid.trace.noise_floor.input_noise import NoiseLevel
from pipelines.shared.augmented import augmented, by_recording, commands, further_traces
from pipelines.shared.modelling import model_of

NARROWED = (Width("carriage.epsilon", "m/s", 1e-3, 8.5e-05),)


def test_the_command_by_effects_says_how_sign_v_is_smoothed(settings):
    given = settings()
    by_file, by_effects = commands(given, Path("model.json"), 250, NARROWED)
    assert by_file.endswith(" model=model.json estimator.horizon=250 estimator.start=guess"), (
        "that file holds the width, and where the trace ended"
    )
    assert " parameters.carriage.epsilon.guess=8.5e-05 estimator.horizon=250" in by_effects
    assert "epsilon" not in commands(given, Path("model.json"), 250)[1]
    weights = {"speed": NoiseLevel(0.15, "m/s")}
    for one in commands(given, Path("model.json"), 250, weights=weights):
        assert " +signals.outputs.speed.noise=0.15 " in one


def test_the_commands_take_the_steps_of_the_trace_where_a_fit_would_not(settings):
    for one in commands(settings(), Path("model.json"), 250, steps=704):
        assert one.endswith(" estimator.integrator=rk4 estimator.substeps=704")
    assert all("substeps" not in one for one in commands(settings(), Path("model.json"), 250))


def test_the_commands_judge_over_the_horizons_of_the_trace(settings):
    """So their errors are those that the trace has shown."""
    for one in commands(settings(), Path("model.json"), 350, seconds=1.4):
        assert " estimator.horizon=350 validate.horizon=1.4" in one
    for seconds in (None, settings()["validate.horizon"]):
        longer = commands(settings(), Path("model.json"), 250, seconds=seconds)
        assert all("validate.horizon" not in one for one in longer)


def test_what_was_typed_is_said_again_unless_the_command_says_it_otherwise(settings):
    typed = (
        "case=short", "trace.processes=1", "+signals.outputs.position.noise=3e-05", "estimator.horizon=100",
        "parameters.M.guess=90", "mlflow.tracking_uri=http://me:secret@host", "force=true",
    )  # fmt: skip
    given = replace(settings(), words=typed)
    by_file, by_effects = commands(given, Path("model.json"), 250)
    start = f"hybridid run case={given.case} "
    assert by_file == (
        f"{start}+signals.outputs.position.noise=3e-05 model=model.json estimator.horizon=250 "
        "estimator.start=guess"
    )
    assert by_effects.startswith(f"{start}+signals.outputs.position.noise=3e-05 parameters.M.guess=90 ")
    (further,) = further_traces(given, ("trace.revise=true seeks others.",))
    assert further.endswith("estimator.horizon=100 parameters.M.guess=90 trace.revise=true")
    assert " trace.processes=1 " in further
    assert "secret" not in by_file + by_effects + further


def test_what_the_cautions_advise_is_a_command(settings):
    given = settings({"mlflow": {"enabled": False}})
    start = f"hybridid trace case={given.case} mlflow.enabled=false"
    cautions = (
        "Only 17 horizons judge. With trace.records=null trace.held_out=null parts of every record do.",
    )
    assert further_traces(given, cautions) == (f"{start} trace.records=null trace.held_out=null",)
    assert further_traces(given, ("trace.revise=true seeks others.",)) == (f"{start} trace.revise=true",)
    assert further_traces(given, ("Beware.",)) == ()


def test_the_commands_write_where_the_trace_wrote(settings):
    usual = commands(settings(), Path("model.json"), 250)
    assert all("paths.outputs" not in one for one in usual)
    given = settings({"paths": {"outputs": "/tmp/my results"}, "mlflow": {"enabled": False}})
    for one in commands(given, Path("model.json"), 250):
        assert "'paths.outputs=/tmp/my results' mlflow.enabled=false" in one


def test_recordings_that_disagree_get_values_of_their_own_by_a_trace(settings):
    words = ("parameters.M.by=record", "fit.records=null", "trace.held_out=null")
    given = settings({"mlflow": {"enabled": False}})
    (command,) = by_recording(given, words)
    assert command == f"hybridid trace case={given.case} mlflow.enabled=false {' '.join(words)}"
    assert by_recording(given, ()) == ()


def test_the_model_of_a_trace_begins_where_the_trace_ended(settings):
    """All its parameters, not only those of what was added; one that is nothing keeps its scale."""
    given = settings({"effects": ["viscous", "coulomb"], "parameters": {"M": {"lower": 50.0}}})
    model = model_of(given)
    values = {"M": 93.5, "carriage.viscous.f_v": 1e-9, "carriage.coulomb.f_c": 21.5}
    better = model_of(augmented(given, [], {}, SimpleNamespace(values=values), (), model.free))
    begun, declared = ({p.name: p for p in one.parameters} for one in (better, model))
    assert {name: begun[name].guess for name in values} == {**values, "carriage.viscous.f_v": 0.0}
    assert begun["carriage.viscous.f_v"].scale == declared["carriage.viscous.f_v"].scale
    assert begun["M"].lower == 50.0
