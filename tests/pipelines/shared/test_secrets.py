"""Passwords and tokens are kept in the environment, and masked wherever they could be seen."""

from __future__ import annotations

import io
import logging
import os
import sys
import traceback

import pytest

from pipelines.shared import secrets
from pipelines.shared.secrets import masked, masked_below, moved_to_environment, noted, typed

NAMES = (secrets.USERNAME, secrets.PASSWORD, secrets.DATABASE_PASSWORD, "MLFLOW_TRACKING_TOKEN")


@pytest.fixture(autouse=True)
def no_secrets(monkeypatch):
    for name in NAMES:
        monkeypatch.setenv(name, "")  # so that what a test sets is taken back
        monkeypatch.delenv(name)


@pytest.mark.parametrize(
    ("text", "shown"),
    [
        ("to https://alice:s3cret@host:5000/x (no)", "to https://***@host:5000/x (no)"),
        (r"tracking_uri=http\://alice\:s3cret@host\:9", r"tracking_uri=http\://***@host\:9"),
        ("https://token@host/x", "https://***@host/x"),
        ("https://alice:p@ss@host", "https://***@host"),
        ("mysql+pymysql://alice:s3cret@host/runs", "mysql+pymysql://***@host/runs"),
        ("mysql://host/runs?user=a&password=s3cret&x=1", "mysql://host/runs?user=a&password=***&x=1"),
        ("https://host/file?sig=s3cret%3D", "https://host/file?sig=***"),
        ("{'Authorization': 'Basic YWxpY2U6czNjcmV0'}", "{'Authorization': 'Basic ***'}"),
        ("Bearer eyJhbGciOi.J9", "Bearer ***"),
        ('"https://alice:s3cret@host", "bob@host"', '"https://***@host", "bob@host"'),
    ],
)
def test_what_is_masked_wherever_it_stands(text, shown):
    assert masked(text) == shown


@pytest.mark.parametrize(
    "text",
    [
        "http://127.0.0.1:5000", "http://[::1]:5000/a@b", "http://host:5000 and bob@host",
        "sqlite:////tmp/x.db", "viscous@carriage", "postgresql://alice@host/runs", "a basic model",
        "https://host/x?key_of=1",
    ],
)  # fmt: skip
def test_what_is_none_stays(text):
    assert masked(text) == text


def test_values_of_the_environment_are_masked(monkeypatch):
    monkeypatch.setenv("AWS_SECRET_ACCESS_KEY", "abc/def+ghi")
    monkeypatch.setenv("SOME_TOKEN", "true")
    assert (
        masked("key abc/def+ghi, in an address abc%2Fdef%2Bghi: true") == "key ***, in an address ***: true"
    )


def test_a_secret_that_takes_the_place_of_another_is_masked(monkeypatch):
    """As many variables as before were taken for the same ones."""
    monkeypatch.setenv("SOME_TOKEN", "first-secret")
    assert masked("first-secret") == "***"
    monkeypatch.setenv("SOME_TOKEN", "second-secret")
    assert masked("second-secret") == "***"


def test_a_short_password_is_masked_where_it_stands_alone(monkeypatch):
    monkeypatch.setenv(secrets.PASSWORD, "emps")
    assert masked("alice:emps, tempsteps") == "alice:***, tempsteps"


def test_whole_configs_are_masked():
    config = {"a": [{"b": "http://u:p@h"}, 1.5, None], "c": ("x", True)}
    assert masked_below(config) == {"a": [{"b": "http://***@h"}, 1.5, None], "c": ["x", True]}


def test_a_servers_password_moves_to_where_mlflow_looks_for_it():
    config = {"mlflow": {"enabled": True, "tracking_uri": "https://alice:p%40ss@host/x"}, "a": 1}
    moved = moved_to_environment(config)
    assert moved == {"mlflow": {"enabled": True, "tracking_uri": "https://host/x"}, "a": 1}
    assert (os.environ[secrets.USERNAME], os.environ[secrets.PASSWORD]) == ("alice", "p@ss")
    assert moved_to_environment(moved) == moved
    assert os.environ[secrets.PASSWORD] == "p@ss"


@pytest.mark.parametrize("config", [{}, {"mlflow": None}, {"mlflow": {"tracking_uri": None}}, {"mlflow": 3}])
def test_a_config_without_one_stays(config):
    assert moved_to_environment(config) == config
    assert not set(NAMES) & set(os.environ)


def test_a_databases_password_moves_too_and_comes_back_for_the_client_alone():
    assert noted("postgresql://alice:p%2Fw@host/runs") == "postgresql://alice@host/runs"
    assert os.environ[secrets.DATABASE_PASSWORD] == "p/w"
    assert secrets.with_password("postgresql://alice@host/runs") == "postgresql://alice:p%2Fw@host/runs"
    for uri in ("sqlite:////tmp/x@y.db", "http://host:5000", "postgresql://host/runs", "mysql://a:b@host/r"):
        assert secrets.with_password(uri) == uri


def test_typed_words_lose_it():
    mirror = "archive.url=https://a:b@host/x.zip"
    words = ["case=emps", "mlflow.tracking_uri=https://alice:s3cret@host", mirror]
    assert typed(words) == ["case=emps", "mlflow.tracking_uri=https://host", mirror]
    assert os.environ[secrets.PASSWORD] == "s3cret"


def test_nothing_that_is_printed_shows_it(monkeypatch):
    """Tracebacks and log lines of libraries, too."""
    out, err = io.StringIO(), io.StringIO()
    monkeypatch.setattr(sys, "stdout", out)
    monkeypatch.setattr(sys, "stderr", err)
    secrets.mask_streams()
    secrets.mask_streams()
    sys.stdout.write("at https://alice:s3cret@host\n")
    sys.stdout.writelines(["https://alice:s3cret@host\n"])
    handler = logging.StreamHandler()
    handler.emit(logging.LogRecord("requests", 30, "", 0, "https://alice:s3cret@host", None, None))
    try:
        raise ConnectionError("API request to https://alice:s3cret@host/api failed")
    except ConnectionError:
        traceback.print_exc()
    assert out.getvalue() == "at https://***@host\nhttps://***@host\n"
    assert "s3cret" not in err.getvalue()
    assert err.getvalue().startswith("https://***@host\n")
    assert err.getvalue().endswith("API request to https://***@host/api failed\n")
    assert not sys.stdout.isatty()
