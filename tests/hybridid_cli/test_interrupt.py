"""Ctrl-C: one line, exit code 130, nothing half-written, and the next command goes on from there."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

# the virtual rig's records are made in one go; the fit is long enough to be struck in its midst
LONG = ("case=emps", "data=simulated", "rig.duration=6", "mlflow.enabled=false", "out=tree")


def interrupted(
    environment: dict[str, str], words: tuple[str, ...], line: str, wait: float
) -> tuple[int, str, str]:
    """Start ``hybridid``, wait for ``line`` on stderr and a little longer, then press Ctrl-C."""
    process = subprocess.Popen(
        [sys.executable, "-m", "hybridid_cli", *words],
        env=environment, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, start_new_session=True,
    )  # fmt: skip
    assert process.stderr is not None
    seen = ""
    for text in process.stderr:
        seen += text
        if line in text:
            break
    time.sleep(wait)
    os.killpg(process.pid, signal.SIGINT)
    out, rest = process.communicate(timeout=60)
    return process.returncode, out, seen + rest


@pytest.mark.parametrize("wait", [0.0, 0.4])
@pytest.mark.parametrize("method", ["gauss_newton", "multiple_shooting"])
def test_ctrl_c_in_the_midst_of_a_fit(environment, process, method, wait):
    words = ("fit", *LONG, f"estimator={method}", "estimator.starts=20")
    code, out, err = interrupted(environment, words, "fit: not made yet", wait)
    assert code == 130, err
    assert out == ""
    assert "Traceback" not in err
    assert err.strip().splitlines()[-1].startswith("hybridid: interrupted")
    assert (Path("tree") / "preprocess" / "records.json").exists(), "what was finished is gone"
    assert sorted(p.name for p in Path("tree").iterdir() if p.name != ".lock") == [
        "config.yaml",
        "preprocess",
    ]
    if method == "gauss_newton" and not wait:
        again = process("fit", *LONG, "estimator.starts=1")
        assert again.code == 0, again.err


def test_ctrl_c_while_python_still_imports(environment):
    process = subprocess.Popen(
        [sys.executable, "-m", "hybridid_cli", "fit", *LONG],
        env=environment, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, start_new_session=True,
    )  # fmt: skip
    time.sleep(0.4)
    os.killpg(process.pid, signal.SIGINT)
    _, err = process.communicate(timeout=60)
    assert process.returncode == 130
    assert err.strip().startswith("hybridid: interrupted")
    assert err.count("\n") == 1
