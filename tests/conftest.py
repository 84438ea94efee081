"""What every test stands on: no network chatter, nobody's home touched, one thread a process."""

from __future__ import annotations

import gc
import os
import signal
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

# before numpy is imported: pytest-xdist already uses every core
for variable in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "NUMBA_NUM_THREADS"):
    os.environ.setdefault(variable, "1")
# figures go to files; MLflow sends its maker nothing
os.environ.update(MPLBACKEND="Agg", MLFLOW_DISABLE_TELEMETRY="true", DO_NOT_TRACK="true")
# a user's own settings must not decide what a test sees
for variable in ("MLFLOW_TRACKING_URI", "MLFLOW_EXPERIMENT_NAME", "MLFLOW_RUN_ID", "HYDRA_FULL_ERROR"):
    os.environ.pop(variable, None)

# a shell that starts the tests in the background lets them ignore Ctrl-C, and nohup the end of the terminal
signal.signal(signal.SIGINT, signal.default_int_handler)
signal.signal(signal.SIGHUP, signal.SIG_DFL)

DATA_VARIABLE = "HYBRIDID_DATA"
NO_DATA = f"needs measured records: set {DATA_VARIABLE}"


def pytest_collection_finish() -> None:
    """What is loaded by now stays: no search for garbage looks through it again."""
    gc.collect()
    gc.freeze()


def pytest_unconfigure() -> None:
    """Nor does the last one, as the process ends."""
    gc.freeze()


@pytest.fixture(scope="session")
def of_the_run(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder that the processes of pytest-xdist share; each run begins with an empty one."""
    own = tmp_path_factory.getbasetemp()
    return own.parent if "PYTEST_XDIST_WORKER" in os.environ else own


@pytest.fixture(scope="session", autouse=True)
def own_home(tmp_path_factory: pytest.TempPathFactory, of_the_run: Path) -> Iterator[Path]:
    """A home folder of the test session's own, for this process and those it starts. Compiled models and the
    list of fonts are made once in a run."""
    home = tmp_path_factory.mktemp("home")
    folders = {
        "HOME": home,
        "XDG_CACHE_HOME": of_the_run / "cache",
        "XDG_CONFIG_HOME": home / ".config",
        "MPLCONFIGDIR": of_the_run / "matplotlib",
    }
    with pytest.MonkeyPatch.context() as patch:
        for name, folder in folders.items():
            folder.mkdir(exist_ok=True)
            patch.setenv(name, str(folder))
        yield home


@pytest.fixture(autouse=True)
def own_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Each test runs in an empty folder, so whatever it writes relatively stays out of the checkout."""
    monkeypatch.chdir(tmp_path)
    return tmp_path


@pytest.fixture(scope="session")
def measured() -> Path:
    """The root of the measured records (``emps/DATA_EMPS.mat`` and so on), or a visible skip."""
    if not os.environ.get(DATA_VARIABLE):
        pytest.skip(NO_DATA)
    root = Path(os.environ[DATA_VARIABLE])
    if not root.is_dir():
        pytest.fail(f"{DATA_VARIABLE} is {root}, which is not a folder")
    return root


@pytest.fixture
def no_figures(monkeypatch: pytest.MonkeyPatch) -> None:
    """The trace of this process draws none: they take longer than a short trace."""
    monkeypatch.setattr("pipelines.trace.stage._drawn", lambda job, found: [])


@pytest.fixture
def nothing_imported(monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    """No folder of own code yet; afterwards the modules from there are forgotten again."""
    from pipelines.shared import own_code, trust

    monkeypatch.setattr(own_code, "_folders", [])
    monkeypatch.setattr(trust, "_admitted", set())
    for name in ("path", "path_hooks"):
        monkeypatch.setattr(sys, name, list(getattr(sys, name)))
    before = set(sys.modules)
    yield
    for name in set(sys.modules) - before:
        if any(Path(place).is_relative_to(f) for place in _files(name) for f in own_code.importable()):
            del sys.modules[name]
    sys.path_importer_cache.clear()


def _files(name: str) -> list[str]:
    module = sys.modules[name]
    return [*filter(None, [getattr(module, "__file__", None)]), *getattr(module, "__path__", [])]
