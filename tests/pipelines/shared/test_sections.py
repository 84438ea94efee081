"""A default stands in one place: what Hydra reads in conf/ is what the dataclasses of the sections say."""

from __future__ import annotations

import typing
from dataclasses import fields, is_dataclass
from typing import Any

import pytest
import yaml

from hybridid.settings import check, declared, keys
from hybridid.settings.choices import Integrator
from hybridid.simulation.integrators import INTEGRATORS
from hybridid_cli.config_files import conf_folder
from pipelines.shared.config import Settings
from pipelines.shared.errors import ConfigError
from pipelines.shared.sections.known import SECTIONS
from pipelines.shared.sections.residual import KINDS, NARXSection, RBFSection
from pipelines.shared.sections.stages import LoneKeys, ReproduceKeys, UiKeys

# of each file: its keys at the top that stand in no section, and the sections that it holds whole
FILES = {
    "base": ("preprocess", "fit", "validate", "plot", "trace", "limits", "mlflow"),
    "sweep": ("sweep",),
    "tune": ("tune",),
}
WHOLE = {
    "estimator/gauss_newton": SECTIONS["estimator"],
    "residual/narx": NARXSection,
    "residual/rbf": RBFSection,
    "paths/default": SECTIONS["paths"],
}


def contents(name: str) -> dict[str, Any]:
    return yaml.safe_load((conf_folder() / f"{name}.yaml").read_text())


def plain(value: Any) -> Any:
    """Dataclasses, tuples and lists alike."""
    if is_dataclass(value):
        return {f.name: plain(getattr(value, f.name)) for f in fields(value)}
    return [plain(item) for item in value] if isinstance(value, list | tuple) else value


def defaults_of(cls: type) -> dict[str, Any]:
    """By key, as a config holds it."""
    follows = {d.name: d.setting.follows for d in declared(cls)}
    return {
        key: f"${{{follows[key]}}}" if follows.get(key) else plain(f.default) for key, f in keys(cls).items()
    }


@pytest.mark.parametrize(("file", "section"), [(f, s) for f, names in FILES.items() for s in names])
def test_sections_have_the_defaults_of_their_dataclasses(file, section):
    written = contents(file)[section]
    expected = defaults_of(SECTIONS[section])
    if section == "tune":
        assert written.pop("space")  # the file says what is varied unless asked otherwise
        del expected["space"]
    assert written == expected


@pytest.mark.parametrize("file", WHOLE)
def test_files_of_a_section_have_its_defaults(file):
    expected = defaults_of(WHOLE[file])
    written = {
        k: [v] if isinstance(expected.get(k), list) and not isinstance(v, list) else v
        for k, v in contents(file).items()
    }  # a lone value stands for a list of one
    assert written == expected


def test_lone_keys_have_their_defaults():
    base = contents("base")
    del base["defaults"], base["hydra"]
    assert {k: v for k, v in base.items() if k not in SECTIONS} == defaults_of(LoneKeys)
    assert base.pop("controller") is None  # a case may have one
    assert {k: v for k, v in base.items() if k in SECTIONS}.keys() == set(FILES["base"])
    assert contents("ui")["port"] == defaults_of(UiKeys)["port"]
    assert contents("reproduce").keys() - {"defaults", "hydra"} == set(keys(ReproduceKeys))


@pytest.mark.parametrize("cls", [*SECTIONS.values(), *KINDS.values(), LoneKeys, UiKeys])
def test_every_key_says_in_one_line_what_it_means(cls):
    for one in declared(cls):
        assert one.setting.meaning, one.name
        assert "\n" not in one.setting.meaning
    if all(f.default is not f.default_factory for f in keys(cls).values()):
        check(cls(), "section")


def test_words_to_choose_from_are_those_that_there_are():
    assert set(typing.get_args(Integrator)) == set(INTEGRATORS)


@pytest.mark.parametrize(
    ("config", "line"),
    [
        ({"mlflow": {"enabled": "no"}}, "mlflow.enabled is 'no': expected true or false"),
        ({"mlflow": {"enabled": "off"}}, "mlflow.enabled is 'off': expected true or false"),
        ({"mlflow": {"enabled": "maybe"}}, "mlflow.enabled is 'maybe': expected true or false"),
        ({"mlflow": {"enabled": 1}}, "mlflow.enabled is 1: expected true or false"),
        ({"mlflow": {"enabled": None}}, "mlflow.enabled is null: expected true or false"),
        ({"paths": {"outputs": None}}, "paths.outputs is null: expected text"),
        ({"force": "no"}, "force is 'no': expected true or false"),
        ({"mlflow": {"patience": -1}}, "mlflow.patience is -1.0: at least 0 s"),
        ({"mlflow": {"patience": True}}, "mlflow.patience is True: expected a number"),
        ({"residual": {"kind": "narx", "increment": "no"}},
         "residual.increment is 'no': expected true or false"),
        ({"residual": {"kind": "nark"}},
         "unknown residual.kind 'nark': did you mean 'narx'? allowed: narx, rbf"),
        ({"data": "simulate"},
         "data is 'simulate': did you mean 'simulated'? allowed: auto, measured, simulated"),
    ],
)  # fmt: skip
def test_what_every_command_reads_is_checked_at_once(config, line):
    with pytest.raises(ConfigError) as caught:
        Settings("mine", config)
    assert str(caught.value) == line


@pytest.mark.parametrize(
    ("name", "section", "line"),
    [
        ("trace", {"worth": 1}, "trace.worth is 1.0: must lie between 0 and 1"),
        ("trace", {"horizon": "soon"}, "trace.horizon is 'soon': expected auto or a number"),
        ("trace", {"horizon": float("inf")}, "trace.horizon is inf: must be a positive number of s"),
        ("trace", {"most_effects": 1.5}, "trace.most_effects is 1.5: expected a whole number"),
        ("estimator", {"horizon": 1},
         "estimator.horizon is 1: at least 2 samples, or null for the whole record"),
        ("estimator", {"method": "newton"},
         "estimator.method is 'newton': did you mean 'gauss_newton'? "
         "allowed: gauss_newton, multiple_shooting"),
        ("estimator", {"seed": -1}, "estimator.seed is -1: must be a whole number from 0 to 2^63 - 1"),
        ("validate", {"views": []}, "validate.views is []: give at least one of free_run, horizon, loop"),
        ("validate", {"horizon": True}, "validate.horizon is True: must be a positive number of s"),
        ("sweep", {"stack": 0}, "sweep.stack is 0: at least 1, or null for what the machine suggests"),
        ("tune", {"processes": True}, "tune.processes is True: expected a whole number"),
    ],
)  # fmt: skip
def test_one_line_names_the_key_and_what_is_allowed(name, section, line):
    with pytest.raises(ConfigError) as caught:
        Settings("mine", {name: section}).section(name, SECTIONS[name])
    assert str(caught.value) == line


def test_rules_that_no_config_may_set_are_no_keys():
    with pytest.raises(ConfigError, match="unknown config key below trace 'collinear'"):
        Settings("mine", {"trace": {"collinear": 0.5}})


def test_a_record_called_by_a_number_is_found():
    section = Settings("mine", {"fit": {"records": [2024]}}).section("fit", SECTIONS["fit"])
    assert section.records == ("2024",)
