"""A file that names code makes none run that the user did not trust before."""

from __future__ import annotations

import json
import os
import sys
from pathlib import Path

import pytest

from pipelines.runner import run_stages
from pipelines.shared.augmented import taken_up
from pipelines.shared.errors import ConfigError
from pipelines.shared.fitted import load
from pipelines.shared.imports import named
from pipelines.shared.modelling import model_of
from pipelines.shared.own_code import make_importable
from pipelines.shared.remembered import place_of
from pipelines.shared.trust import TRUSTED, Untrusted, admit, all_trusted, is_trusted, paths_in, trust

pytestmark = pytest.mark.usefixtures("nothing_imported")


@pytest.fixture
def received(own_folder, monkeypatch):
    """A folder of somebody else, whose module says so when it runs."""
    monkeypatch.setenv("XDG_CONFIG_HOME", str(own_folder / "config"))
    folder = own_folder / "received"
    folder.mkdir()
    (folder / "theirs_of_test.py").write_text(
        "from pathlib import Path\n"
        "from hybridid.plants.emps import EMPS\n"
        f"Path({str(own_folder / 'ran')!r}).touch()\n"
        "PLANT = EMPS()\n"
    )
    (folder / "matplotlib.py").write_text(f"open({str(own_folder / 'ran')!r}, 'w')")
    return folder


@pytest.fixture
def ran(own_folder):
    return lambda: (own_folder / "ran").exists()


PATH = "theirs_of_test:PLANT"


def test_what_is_hybridids_may_run_and_its_folders_are_not_even_looked_at(received, ran):
    admit("it", ["hybridid.plants.emps:EMPS", "hybridid.effects.friction:COULOMB"], [received])
    assert str(received) not in sys.path
    assert not ran()


def test_code_of_a_folder_waits_for_trust_and_trust_ends_with_a_change(received, ran):
    with pytest.raises(Untrusted, match=f"it names {PATH}, code in {received}, .* hybridid trust {received}"):
        admit("it", [PATH], [received])
    assert str(received) not in sys.path
    trust(received)
    (received / "another.py").write_text("")
    with pytest.raises(Untrusted):
        admit("it", [PATH], [received])
    trust(received)
    assert not ran()
    admit("it", [PATH], [received])
    assert named(PATH, "plant").name == "emps"
    assert ran()


def test_a_folder_that_the_user_names_needs_no_trust(received, ran):
    make_importable([received])
    admit("it", [PATH], [received])
    assert not ran(), "it only may"


@pytest.mark.parametrize("path", ["this:s", "pip.__main__:main", "hybridid_cli.__main__:main", "os:system"])
def test_what_is_installed_is_not_imported_because_a_file_says_so(received, path, capsys):
    sys.modules.pop("this", None)
    with pytest.raises(ConfigError, match=f"it names {path}, which is neither hybridid's nor in a folder"):
        admit("it", [path], [received])
    assert "Zen" not in capsys.readouterr().out


def test_what_the_users_own_config_names_may_run(received):
    admit("it", ["ourlab.plants:ARM"], [], own=["ourlab.plants:LEG"])


def test_a_trusted_folder_cannot_stand_for_a_library(received, ran):
    (received / "colorsys.py").write_text("X = 1")
    trust(received)
    with pytest.raises(ConfigError, match="colorsys is already the name of"):
        admit("it", ["colorsys:X"], [received])


def test_control_characters_of_a_file_do_not_reach_the_terminal(received):
    with pytest.raises(ConfigError) as raised:
        admit("it", ["\x1b[2Jevil\n:X"], [received])
    assert str(raised.value).isprintable()


def test_trust_is_private(received, own_folder):
    given = trust(received)
    store = own_folder / "config" / "hybridid" / "trusted"
    assert [file.name for file in store.iterdir()] == [given.digest]
    assert (store / given.digest).stat().st_mode & 0o777 == 0o600
    assert store.stat().st_mode & 0o777 == 0o700
    assert all_trusted() == [given]
    assert given.folder == str(received)


def test_trust_that_others_could_have_written_is_not_believed(received):
    trust(received)
    place_of(TRUSTED).chmod(0o777)
    assert not is_trusted(received)
    with pytest.raises(Untrusted, match="what you agreed to is not read: others may write to"):
        admit("it", [PATH], [received])
    with pytest.raises(ConfigError, match="others may write to"):
        all_trusted()
    with pytest.raises(ConfigError, match="cannot be remembered: others may write to"):
        trust(received)


@pytest.mark.skipif(os.geteuid() != 0, reason="only root can give a file to another user")
def test_trust_written_by_another_user_is_not_believed(received):
    given = trust(received)
    os.chown(place_of(TRUSTED) / given.digest, 65534, 65534)
    assert not is_trusted(received)


def test_what_cannot_be_trusted(own_folder):
    with pytest.raises(ConfigError, match="nowhere: no such folder"):
        trust(own_folder / "nowhere")


def test_every_key_that_names_code_is_looked_at():
    config = {
        "plant": "a:A", "effects": ["viscous", "b:B@carriage", "c:C"], "rig": {"path": "d:D"},
        "trace": {"effects": ["e:E"], "extra_effects": ("f:F", "coulomb")},
    }  # fmt: skip
    assert paths_in(config) == ["a:A", "d:D", "b:B", "c:C", "e:E", "f:F"]
    assert paths_in({"plant": None, "effects": None, "trace": None, "rig": None}) == []
    assert paths_in({"effects": "b:B"}) == [], "what is no list is refused elsewhere"


def as_theirs(path: Path, folder: Path, **changes: object) -> None:
    """Let a model.json name ``folder`` and other keys of its config."""
    described = json.loads(path.read_text())
    described["python_folders"] = [str(folder)]
    described["config"] |= changes
    path.write_text(json.dumps(described))


@pytest.fixture
def tree(settings, heard, data):
    return run_stages(settings(), "fit", heard).tree


def test_a_received_model_is_taken_up_only_when_trusted(settings, tree, received, ran):
    as_theirs(tree / "fit/model.json", received, plant=PATH)
    config = {**settings().config, "model": str(tree / "fit")}
    with pytest.raises(Untrusted, match=r"model is .*/fit/model\.json: it names theirs_of_test:PLANT"):
        taken_up(config)
    assert not ran()
    trust(received)
    assert model_of(settings(taken_up(config))).plant.name == "emps"
    assert ran()


def test_a_received_tree_is_loaded_only_when_its_code_is_trusted_or_named(tree, received, ran):
    as_theirs(tree / "fit/model.json", received, plant=PATH)
    with pytest.raises(Untrusted, match="hybridid trust"):
        load(tree)
    assert not ran()
    model, estimate = load(tree, [received])
    assert set(estimate.values) == {p.name for p in model.parameters}
    assert ran()


def test_stages_take_no_code_from_the_files_of_a_tree(settings, heard, tree, received, ran):
    """Its receipts can say that it is fresh, whoever made it."""
    as_theirs(tree / "fit/model.json", received, plant=PATH)
    outcome = run_stages(settings({"validate.views": ["horizon"]}), "validate", heard)
    assert "fit" in outcome.reused
    assert not ran()
