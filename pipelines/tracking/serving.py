"""MLflow's page of all runs, on this machine alone."""

from __future__ import annotations

import os
import signal
import socket
import subprocess
import sys
import tempfile
import time
from pathlib import Path

from hybridid.plain import build
from pipelines.shared.config import Settings
from pipelines.shared.errors import ConfigError
from pipelines.shared.secrets import with_password
from pipelines.shared.sections.stages import UiKeys
from pipelines.shared.watch import Watcher
from pipelines.tracking import guardian
from pipelines.tracking.abandoned import end_abandoned
from pipelines.tracking.patience import END
from pipelines.tracking.runs import client, tracking_uri

HOST = "127.0.0.1"


def serve(settings: Settings, watcher: Watcher) -> None:
    """Serve the page until interrupted; no process of it outlives this one.

    Raises:
        KeyboardInterrupt: when it is.
        ConfigError: if the port is taken or none, or the server ends by itself.
    """
    port = build(UiKeys, {"port": settings.get("port", 5000)}, "", ConfigError).port
    _check_free(port)
    client(settings)  # the page must not race a first run to make the store
    uri = tracking_uri(settings)
    if trouble := end_abandoned(settings):
        watcher.warn(f"runs of killed commands are still RUNNING: {trouble}")
    watcher.say(f"starting MLflow's page for {uri}")
    # no job runner: it serves MLflow's language-model tools, with a dozen processes
    environment = {**os.environ, "MLFLOW_SERVER_ENABLE_JOB_EXECUTION": "false"}
    environment["MLFLOW_BACKEND_STORE_URI"] = _absolute(with_password(uri))  # everybody may read its words
    environment.setdefault("MLFLOW_ARTIFACTS_DESTINATION", str(Path("mlartifacts").resolve()))
    words = ["server", "--host", HOST, "--port", str(port), "--workers", "1"]
    with tempfile.TemporaryFile("w+") as said:
        command = [sys.executable, "-m", guardian.__name__, sys.executable, "-m", "mlflow", *words]
        server = subprocess.Popen(
            command,
            env=environment,
            cwd="/",  # MLflow's server imports from where it stands, whatever PYTHONSAFEPATH says
            process_group=0,
            stdin=subprocess.PIPE,
            stdout=said,
            stderr=said,
        )
        try:
            while server.poll() is None and not _answers(port):
                time.sleep(0.2)
            watcher.say(f"http://{HOST}:{port} is open on this machine; Ctrl-C ends it")
            code = server.wait()
        finally:
            _end(server)
        said.seek(0)
        last = [line for line in said.read().splitlines() if line.strip()][-1:]
        raise ConfigError(f"MLflow's server ended by itself (exit code {code}): {''.join(last)}")


def _absolute(uri: str) -> str:
    """The address of a store, with the path of a file from the root on."""
    for begin in ("sqlite:///", "file:"):
        path = uri.removeprefix(begin)
        if uri.startswith(begin) and not path.startswith("/"):
            return f"{begin}{Path(path).resolve()}"
    return uri if ":" in uri else str(Path(uri).resolve())


def _answers(port: int) -> bool:
    with socket.socket() as probe:
        return probe.connect_ex((HOST, port)) == 0


def _check_free(port: int) -> None:
    with socket.socket() as probe:
        probe.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        try:
            probe.bind((HOST, port))
        except OSError as error:
            raise ConfigError(
                f"port {port} on {HOST}: {error.strerror}; choose another, as in port=5001"
            ) from error


def _end(server: subprocess.Popen[bytes]) -> None:
    """End the server with all its workers."""
    for number in (signal.SIGTERM, signal.SIGKILL):
        try:
            os.killpg(server.pid, number)
            server.wait(END)
        except ProcessLookupError:
            return
        except subprocess.TimeoutExpired:
            continue
