"""Ctrl-C and requests to end: one line, exit code, nothing half-written, and the next command goes on."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from hybridid_cli import interrupt

# the virtual rig's records are made in one go; the fit is long enough to be struck in its midst
LONG = ("case=emps", "data=simulated", "rig.duration=6", "mlflow.enabled=false", "out=tree")


def heeding_all() -> None:
    """Under nohup the tests ignore SIGHUP, and what they start would ignore it too."""
    signal.signal(signal.SIGHUP, signal.SIG_DFL)


def interrupted(
    environment: dict[str, str], words: tuple[str, ...], line: str, wait: float, by: int = signal.SIGINT
) -> tuple[int, str, str]:
    """Start ``hybridid``, wait for ``line`` on stderr and a little longer, then send ``by``."""
    process = subprocess.Popen(
        [sys.executable, "-m", "hybridid_cli", *words],
        env=environment, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, start_new_session=True,
        preexec_fn=heeding_all,
    )  # fmt: skip
    assert process.stderr is not None
    seen = ""
    for text in process.stderr:
        seen += text
        if line in text:
            break
    time.sleep(wait)
    os.killpg(process.pid, by)
    out, rest = process.communicate(timeout=60)
    return process.returncode, out, seen + rest


@pytest.mark.parametrize("wait", [0.0, 0.4])
@pytest.mark.parametrize("method", ["gauss_newton", "multiple_shooting"])
def test_ctrl_c_in_the_midst_of_a_fit(environment, say, method, wait):
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
        again = say("fit", *LONG, "estimator.starts=1")
        assert again.code == 0, again.err


@pytest.mark.parametrize(
    ("by", "says"),
    [(signal.SIGTERM, "told to end (SIGTERM)"), (signal.SIGHUP, "the terminal is closed (SIGHUP)")],
)
def test_a_request_to_end_in_the_midst_of_a_fit(environment, by, says):
    code, out, err = interrupted(
        environment, ("fit", *LONG, "estimator.starts=20"), "fit: not made yet", 0.0, by
    )
    assert code == 128 + by, err
    assert out == ""
    assert err.strip().splitlines()[-1].startswith(f"hybridid: {says}; what was unfinished is discarded")
    assert sorted(p.name for p in Path("tree").iterdir() if p.name != ".lock") == [
        "config.yaml",
        "preprocess",
    ]


def test_nohup_keeps_sighup_ignored(monkeypatch):
    monkeypatch.setattr(sys, "unraisablehook", sys.unraisablehook)
    for seen in (signal.SIG_IGN, signal.SIG_DFL):
        monkeypatch.setattr(signal, "getsignal", lambda number, seen=seen: seen)
        set_now = {}
        monkeypatch.setattr(signal, "signal", set_now.__setitem__)
        interrupt.install()
        assert (signal.SIGHUP in set_now) is (seen is signal.SIG_DFL)
        assert {signal.SIGINT, signal.SIGTERM} <= set(set_now)


def test_a_signal_that_comes_twice_at_once_is_one(monkeypatch):
    monkeypatch.setattr(interrupt, "_seen", None)
    with pytest.raises(interrupt.Interrupted):
        interrupt._interrupt(signal.SIGINT, None)
    interrupt._interrupt(signal.SIGINT, None)
    monkeypatch.setattr(interrupt, "_when", interrupt._when - 2 * interrupt.ONE_PRESS)
    with pytest.raises(interrupt.Interrupted):
        interrupt._interrupt(signal.SIGTERM, None)
    assert interrupt.last().code == 143


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


IN_A_DESTRUCTOR = """
import os, signal, time
from hybridid_cli import interrupt

class Struck:
    def __del__(self):
        os.kill(os.getpid(), signal.SIGTERM)

interrupt.install()
try:
    Struck()
    time.sleep(30)
except interrupt.Interrupted as caught:
    print(caught.code)
"""
AT_THE_END = """
import atexit, os, signal, sys
from hybridid_cli.main import main

atexit.register(os.kill, os.getpid(), signal.SIGTERM)
sys.argv = ["hybridid", "--version"]
main()
"""


@pytest.mark.parametrize(("program", "says"), [(IN_A_DESTRUCTOR, "143"), (AT_THE_END, "hybridid ")])
def test_a_signal_where_python_would_swallow_and_print_it(environment, program, says):
    """In a destructor it is raised again; after the command's work it changes nothing."""
    done = subprocess.run([sys.executable, "-c", program], env=environment, capture_output=True, text=True)
    assert (done.returncode, done.stderr) == (0, "")
    assert done.stdout.startswith(says)


DISGUISED = """
import os, signal, sys
from hybridid_cli import listing
from hybridid_cli.main import main

def struck(*given):
    try:
        os.kill(os.getpid(), signal.SIGTERM)
    except KeyboardInterrupt:
        raise AttributeError("'NoneType' object has no attribute '_invalidate_flags_cache'")

listing.cases = struck
sys.argv = ["hybridid", "cases"]
main()
"""


def test_a_signal_that_a_library_reports_as_something_else(environment):
    """OmegaConf, struck in the midst of a config, complained of an attribute, and the exit code was 2."""
    done = subprocess.run([sys.executable, "-c", DISGUISED], env=environment, capture_output=True, text=True)
    assert done.returncode == 143
    assert done.stderr.startswith("hybridid: told to end (SIGTERM); what was unfinished")
    assert done.stderr.count("\n") == 1
