"""``hybridid ui``: MLflow's page, on this machine alone, and gone when it is ended."""

from __future__ import annotations

import os
import signal
import socket
import subprocess
import sys
import time
import urllib.request
from pathlib import Path

import pytest


def free_port() -> int:
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return int(probe.getsockname()[1])


NEEDS_PROC = pytest.mark.skipif(
    not Path("/proc/net/tcp").exists(), reason="needs /proc to see who listens where"
)


@NEEDS_PROC
def test_page_opens_on_this_machine_alone_and_ends_with_the_command(environment, own_folder):
    """No code of the folder where one stands runs: MLflow's server once imported its ``yaml.py``."""
    for name in ("yaml", "alembic", "sqlalchemy"):
        (own_folder / f"{name}.py").write_text("open('ran', 'w')")
    port = free_port()
    process = subprocess.Popen(
        [sys.executable, "-P", "-m", "hybridid_cli", "ui", f"port={port}", "mlflow.tracking_uri=sqlite:///a.db"],
        env=environment, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, start_new_session=True,
    )  # fmt: skip
    try:
        assert process.stderr is not None
        line = next(line for line in process.stderr if f"http://127.0.0.1:{port} is open" in line)
        assert "this machine" in line
        with urllib.request.urlopen(f"http://127.0.0.1:{port}/", timeout=30) as page:
            assert page.status == 200
            assert b"MLflow" in page.read()
        assert not (own_folder / "ran").exists()
        assert (own_folder / "a.db").exists()
        assert listening(port) == {"0100007F"}, "127.0.0.1, as the kernel writes it"
        process.send_signal(signal.SIGINT)
        assert process.wait(30) == 0
    finally:
        process.kill()
    assert_closed(port)


SERVE = """
import sys
from pipelines.shared.config import Settings
from pipelines.tracking import serving

class Told:
    def say(self, line): print(line, flush=True)

serving.client = lambda settings: None
outputs = {"paths": {"outputs": "outputs"}, "mlflow": {"enabled": True}}
serving.serve(Settings("short", {"port": int(sys.argv[1]), **outputs}), Told())
"""
SERVER = """
import subprocess, sys
port = sys.argv[sys.argv.index("--port") + 1]
subprocess.run([sys.executable, "-m", "http.server", port, "--bind", "127.0.0.1"])
"""


@NEEDS_PROC
def test_a_command_that_is_killed_leaves_no_server(environment, own_folder):
    """A server of Python's own, in a process below the one that is started, stands in for MLflow's."""
    (own_folder / "mlflow").mkdir()
    for name, code in (("__init__", ""), ("__main__", SERVER)):
        (own_folder / f"mlflow/{name}.py").write_text(code)
    port = free_port()
    environment["PYTHONPATH"] = os.pathsep.join([str(own_folder), environment["PYTHONPATH"]])
    words = [sys.executable, "-c", SERVE, str(port)]
    with subprocess.Popen(words, env=environment, stdout=subprocess.PIPE, text=True) as process:
        assert process.stdout is not None
        try:
            assert any(f"http://127.0.0.1:{port} is open" in line for line in process.stdout)
            assert listening(port) == {"0100007F"}
        finally:
            process.kill()
    assert_closed(port)


def assert_closed(port: int) -> None:
    end = time.monotonic() + 10
    while listening(port) and time.monotonic() < end:
        time.sleep(0.1)
    assert not listening(port), "the server outlived the command"


def listening(port: int) -> set[str]:
    """The addresses that listen on ``port``, in the kernel's hexadecimal."""
    found = set()
    for table in ("/proc/net/tcp", "/proc/net/tcp6"):
        for line in Path(table).read_text().splitlines()[1:] if Path(table).exists() else ():
            _, local, _, state, *_ = line.split()
            address, _, number = local.partition(":")
            if int(number, 16) == port and state == "0A":
                found.add(address)
    return found


def test_port_that_is_taken(say):
    with socket.socket() as taken:
        taken.bind(("127.0.0.1", 0))
        taken.listen()
        port = taken.getsockname()[1]
        said = say("ui", f"port={port}")
    assert said.code == 2
    assert f"port {port}" in said.complaint


@pytest.mark.parametrize("port", ["abc", "0", "70000", "true"])
def test_port_that_is_none(say, port):
    said = say("ui", f"port={port}")
    assert said.code == 2
    assert "whole number from 1 to 65535" in said.complaint
