"""Recordings are looked for in order, and where it was looked is said."""

from __future__ import annotations

import hashlib
from pathlib import Path

import pytest

from hybridid.records.sources import RecordNotFoundError, data_roots, digest_of, locate


@pytest.fixture
def roots(tmp_path) -> tuple[Path, Path]:
    for name in ("mine", "lab"):
        (tmp_path / name / "emps").mkdir(parents=True)
    return tmp_path / "mine", tmp_path / "lab"


def test_the_order_of_the_roots():
    found = data_roots("/mine", {"HYBRIDID_DATA": "/lab"}, Path("data/raw"))
    assert [str(root) for root in found] == ["/mine (paths.data)", "/lab ($HYBRIDID_DATA)", "data/raw"]
    assert [root.path for root in data_roots(None, {}, Path("raw"))] == [Path("raw")]
    assert data_roots(None, {"HYBRIDID_DATA": ""}) == data_roots(None, {})
    assert data_roots("~/records", {})[0].path == Path.home() / "records"


def test_the_first_root_that_has_it_wins(roots):
    mine, lab = roots
    (lab / "emps/run.mat").write_text("lab")
    assert locate("emps/run.mat", roots) == lab / "emps/run.mat"
    (mine / "emps/run.mat").write_text("mine")
    assert locate("emps/run.mat", roots) == mine / "emps/run.mat"


def test_an_absolute_path_is_itself(roots):
    file = roots[1] / "emps/run.mat"
    file.write_text("x")
    assert locate(file, ()) == file
    with pytest.raises(RecordNotFoundError, match=r"Run\.mat: no such file, did you mean .*run\.mat\?"):
        locate(file.with_name("Run.mat"), roots)


def test_what_is_not_found_is_one_line(roots):
    (roots[1] / "emps/DATA_EMPS.mat").write_text("x")
    named = data_roots(roots[0], {"HYBRIDID_DATA": str(roots[1])}, Path("data/raw"))
    with pytest.raises(RecordNotFoundError) as caught:
        locate("emps/data_emsp.mat", named)
    message = str(caught.value)
    assert "\n" not in message
    assert f"did you mean {roots[1] / 'emps/DATA_EMPS.mat'}?" in message
    assert f"{roots[0]} (paths.data), {roots[1]} ($HYBRIDID_DATA), data/raw" in message
    with pytest.raises(RecordNotFoundError, match="looked under nowhere: no data root is set"):
        locate("run.mat", [])


def test_a_folder_is_no_recording(roots):
    with pytest.raises(RecordNotFoundError):
        locate("emps", roots)


def test_digests(tmp_path):
    files = [tmp_path / name for name in "ab"]
    for file in files:
        file.write_bytes(file.name.encode())
    assert digest_of(files[:1]) == hashlib.sha256(b"a").hexdigest()
    assert digest_of(files) == digest_of(files[::-1])
    assert digest_of(files) not in {digest_of(files[:1]), digest_of(files[1:])}
    before = digest_of(files)
    files[0].write_bytes(b"c")
    assert digest_of(files) != before
