"""Run folders, folders to stand in, and recordings, with code in them that nobody asked for."""

from __future__ import annotations

import json
from collections.abc import Mapping

from benchmarks.torture.case import Content
from benchmarks.torture.tables.decoys import DECOY, LINE, SHELL, pickled
from benchmarks.torture.tables.received import NAMED, model

TARGET = f"_target_: os.system\ncommand: '{SHELL}'\n_args_: ['{SHELL}']\n"
RUN_FOLDER: Mapping[str, Mapping[str, Content]] = {
    "config.yaml that names a function": {"tree/config.yaml": TARGET},
    "config.yaml with a tag of Python": {
        "tree/config.yaml": f"a: !!python/object/apply:os.system ['{SHELL}']\n"
    },
    "a model of their own": {"tree/theirs_plant.py": DECOY, "tree/fit/model.json": model(plant=NAMED)},
    "a network of their own kind": {
        "tree/theirs_plant.py": DECOY,
        "tree/residual/hybrid.json": '{"format": 1, "kind": "theirs_plant:EFFECT", "physics": []}',
    },
    "a network without its kind": {"tree/residual/hybrid.json": '{"format": 1}'},
    "a network that is a list": {"tree/residual/hybrid.json": "[1, 2]"},
    "weights that are a pickle": {"tree/residual/weights.npz": pickled},
    "receipts that are a pickle": {"tree/fit/receipt.json": pickled},
    "an estimate that is a pickle": {"tree/fit/estimate.json": pickled},
    "code everywhere": {
        f"tree/{folder}/{name}": LINE
        for folder in (".", "fit", "preprocess", "residual", "trace")
        for name in ("__init__.py", "matplotlib.py", "sitecustomize.py", "numpy.py")
    },
}
"""What a run folder may bring in which one goes on."""
HERE: Mapping[str, Content] = {
    **{
        f"{name}.py": LINE
        for name in (
            "matplotlib", "numpy", "casadi", "socket", "json", "sitecustomize", "usercustomize", "mlflow",
            "torch", "pandas", "yaml", "hydra", "joblib", "typing", "emps", "__init__", "conftest", "setup",
        )
    },
    **{
        f"{name}/__init__.py": LINE
        for name in ("hybridid", "hybridid_cli", "pipelines", "hydra_plugins", "encodings", "scipy", "optuna")
    },
    "hydra_plugins/theirs.py": LINE,
    "conf/fit.yaml": TARGET,
    "conf/case/emps.yaml": TARGET,
    "case/emps.yaml": TARGET,
    "fit.yaml": TARGET,
    "config.yaml": TARGET,
    ".hydra/config.yaml": TARGET,
    ".hydra/hydra.yaml": TARGET,
    ".hydra/config.pickle": pickled,
    ".env": "PYTHONSTARTUP=matplotlib.py\nPYTHONPATH=.\n",
    "setup.cfg": "[hydra]\nplugins = theirs\n",
    "pyproject.toml": "[tool.hydra]\n",
    "matplotlibrc": "backend: module://matplotlib\n",
    "theirs.pth": LINE,
    "pyvenv.cfg": "home = .\n",
}  # fmt: skip
"""A folder in which one stands, with a file under each name that a library could look for."""
DATA: Mapping[str, Mapping[str, Content]] = {
    "a pickle": {"lab/swing.pkl": pickled},
    "a pickle that says it is .mat": {"lab/swing.mat": pickled},
    "a pickle that says it is .parquet": {"lab/swing.parquet": pickled},
    "a pickle that says it is .json": {"lab/swing.json": pickled},
    "a pickle that says it is .csv": {"lab/swing.csv": pickled},
    "a pickle that says it is .npz": {"lab/swing.npz": pickled},
    "a formula": {"lab/swing.csv": f"t,torque,angle\n0,=cmd|'{SHELL}',1\n"},
}
"""Recordings that bring code."""
POINT = {
    "case": "emps",
    "config": {"case": {}, "plant": NAMED, "effects": [], "mlflow": {"enabled": False}},
    "folders": ["theirs"],
    "at": {},
}
JOB: Mapping[str, Content] = {
    "theirs/theirs_plant.py": DECOY,
    "theirs/job.json": json.dumps({"name": "j", "points": [POINT], "gray": True, "sweep": "s"}),
}
"""What a launcher's process would carry out."""
