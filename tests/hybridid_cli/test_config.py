"""What Hydra gives: --cfg, overrides, a folder of one's own; and that it leaves nothing behind."""

from __future__ import annotations

from pathlib import Path

import yaml

from hybridid_cli.config_files import conf_folder, keys, options


def test_cfg_prints_the_config_and_does_nothing(say):
    said = say("fit", "case=emps", "estimator.horizon=1000", "effects=[viscous]", "--cfg", "job")
    assert said.code == 0
    config = yaml.safe_load(said.out)
    assert config["estimator"]["horizon"] == 1000
    assert config["effects"] == ["viscous"]
    assert config["parameters"]["M"] == {"lower": 30.0, "upper": 150.0}
    assert "hydra" not in config
    assert list(Path().iterdir()) == []


def test_thesis_search_intervals(say):
    parameters = yaml.safe_load(say("fit", "case=emps", "--cfg", "job").out)["parameters"]
    assert parameters["carriage"]["viscous"]["f_v"] == {"lower": 100.0, "upper": 300.0}
    assert parameters["carriage"]["coulomb"]["f_c"] == {"lower": 0.0, "upper": 40.0}
    assert parameters["carriage"]["offset"]["offset"] == {"lower": -15.0, "upper": 15.0}


def test_estimator_group_inherits(say):
    config = yaml.safe_load(say("fit", "estimator=multiple_shooting", "--cfg", "job").out)
    plain = yaml.safe_load(say("fit", "--cfg", "job").out)
    assert config["estimator"] == {**plain["estimator"], "method": "multiple_shooting"}


def test_new_parameter_keys_need_no_plus(say):
    said = say("fit", "parameters.carriage.stribeck.v_s.guess=0.01", "--cfg", "job")
    assert yaml.safe_load(said.out)["parameters"]["carriage"]["stribeck"] == {"v_s": {"guess": 0.01}}


def test_listed_keys_are_those_that_hydra_composes(say):
    """The quick reader of config files, for completion and nearest names, agrees with Hydra."""
    composed = yaml.safe_load(say("fit", "case=emps", "estimator=multiple_shooting", "--cfg", "job").out)
    assert keys("fit", {"case": "emps", "estimator": "multiple_shooting"}) == dict(flat(composed))
    assert options("case") == sorted(p.stem for p in (conf_folder() / "case").glob("*.yaml"))


def flat(node, prefix=""):
    for key, value in node.items():
        if isinstance(value, dict) and value:
            yield from flat(value, f"{prefix}{key}.")
        else:
            yield f"{prefix}{key}", value


def test_a_run_leaves_nothing_but_its_tree(say, quick):
    assert say("preprocess", *quick).code == 0
    assert [p.name for p in Path().iterdir()] == ["outputs"]
    assert [p.name for p in Path("outputs").iterdir()] == ["emps"]


def test_case_without_package_header_is_explained(say, quick):
    Path("mylab/case").mkdir(parents=True)
    Path("mylab/case/mine.yaml").write_text("plant: hybridid.plants.emps:EMPS\n")
    said = say("fit", "--config-dir", "mylab", "case=mine")
    assert said.code == 2
    assert "# @package _global_" in said.complaint


def test_misspelt_key_in_a_case_of_ones_own(say):
    Path("mylab/case").mkdir(parents=True)
    Path("mylab/case/mine.yaml").write_text("# @package _global_\nplnt: hybridid.plants.emps:EMPS\n")
    said = say("fit", "--config-dir", "mylab", "case=mine")
    assert said.code == 2
    assert "unknown config key 'plnt': did you mean 'plant'?" in said.complaint
