"""The commands that are struck, each on a short simulated record, and what must have run before it."""

from __future__ import annotations

from collections.abc import Callable
from contextlib import AbstractContextManager, nullcontext
from dataclasses import dataclass

from benchmarks.torture.mirror import mirror

Words = tuple[str, ...]
OFTEN, LESS, SELDOM = 30, 16, 8
QUICK = ("case=emps", "data=simulated", "rig.duration=1.2")
NETWORK = (
    "residual=narx", "residual.orders={error: 2, inputs: 1, gray: 1}", "residual.every=5",
    "residual.horizons=[1]", "residual.depth=1", "residual.width=4", "residual.seeds=0", "residual.epochs=3",
)  # fmt: skip
WIDTHS = tuple("residual.width=4,6,8" if word == "residual.width=4" else word for word in NETWORK)
SPACE = (
    "tune.space.residual.width.high=8", "tune.space.residual.depth=null", "tune.trials=4", "tune.startup=2",
    "tune.processes=2",
)  # fmt: skip
SVG = ("plot.formats=[svg]",)
DOWN = "mlflow.tracking_uri=http://127.0.0.1:9"
"""No server answers at port 9: the run is kept, to be sent later."""
TWO = ("experiments=[emps_horizon,emps_free_run]", "processes=2")


@dataclass(frozen=True)
class Command:
    """``words`` of a command line, in a folder where the lines of ``before`` have run.

    ``draws``: it draws random numbers in an order that depends on when it was struck, so that only the number
    of its results is compared. ``opens``: it ends when it is told to, and is ready when it says this.
    ``around`` holds what must be there while it runs. ``alone``: it must run in a process of this one.
    ``makes``: a folder that it makes, and refuses to make again.
    ``kills``: how often it is struck; less often if it takes long.
    """

    name: str
    words: Words
    before: tuple[Words, ...] = ()
    draws: bool = False
    opens: str = ""
    around: Callable[[], AbstractContextManager[object]] = nullcontext
    alone: bool = False
    makes: str = ""
    kills: int = OFTEN


_PREPROCESS = ("preprocess", *QUICK)
_FIT = ("fit", *QUICK)
_RESIDUAL = ("residual", *QUICK, *NETWORK)
_VALIDATE = ("validate", *QUICK)
_TRACE = ("trace", *QUICK, "trace.effects=[stribeck]", "trace.processes=2")
_STORE = "mlflow.tracking_uri=sqlite:///{lab}/outputs/mlflow.db"

COMMANDS: tuple[Command, ...] = (
    Command("preprocess", _PREPROCESS),
    Command("fit", _FIT, (_PREPROCESS,)),
    Command("fit, multiple shooting", (*_FIT, "estimator=multiple_shooting"), (_PREPROCESS,)),
    Command("residual", _RESIDUAL, (_FIT,)),
    Command("validate", _VALIDATE, (_FIT,)),
    Command("plot", ("plot", *QUICK, *SVG), (_VALIDATE,), kills=LESS),
    Command("trace", _TRACE, (_FIT,), kills=SELDOM),
    Command("trace, other options", (*_TRACE, "trace.horizon=0.3"), (_TRACE,), kills=SELDOM),
    Command("run", ("run", *QUICK, *NETWORK, *SVG), kills=SELDOM),
    Command(
        "fit -m, joblib",
        ("fit", "-m", *QUICK, "launcher=joblib", "estimator.horizon=250,500"),
        (_PREPROCESS,),
        kills=SELDOM,
    ),
    Command("sweep", ("sweep", *QUICK, *WIDTHS, "sweep.stack=1", "sweep.processes=2"), (_FIT,), kills=SELDOM),
    Command(
        "sweep, joblib",
        ("sweep", *QUICK, "launcher=joblib", "estimator.horizon=250,500"),
        (_PREPROCESS,),
        kills=SELDOM,
    ),
    Command("tune", ("tune", *QUICK, *NETWORK, *SPACE), (_FIT,), draws=True, kills=SELDOM),
    Command(
        "reproduce", ("reproduce", "data=simulated", "rig.duration=1.2", *TWO), (_PREPROCESS,), kills=SELDOM
    ),
    Command("fetch", ("fetch", "emps", "paths.data=raw", "mlflow.enabled=false"), around=mirror, alone=True),
    Command("log", ("log", *QUICK, _STORE), ((*_FIT, DOWN), (*_VALIDATE, DOWN))),
    Command(
        "new",
        ("new", "rig", "--from", "outputs/first/preprocess/identification.parquet", "--template", "carriage"),
        ((*_PREPROCESS, "out=outputs/first"),),
        makes="rig",
    ),
    Command("ui", ("ui", *QUICK, "port={port}"), (_PREPROCESS,), opens="is open on this machine", kills=LESS),
    Command("cases", ("cases",), kills=LESS),
    Command("effects", ("effects",), kills=LESS),
    Command("completion", ("completion", "bash"), kills=LESS),
)
WITH_CONFIG = tuple(c for c in COMMANDS if c.name not in ("ui", "new", "cases", "effects", "completion"))
"""Those that read a config and make results."""
