"""Command lines that ask for what there is not."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import chain, product

from benchmarks.torture.case import BORNE, REFUSED, Case
from benchmarks.torture.lab import OWN, fit

WORDS = (
    "=", "=3", "a.b.c=", "case=", "case", "++", "+", "~", "~case", "~plant", "effects[0]=viscous",
    "estimator=3", "estimator=[a,b]", "estimator=", "case=[a]", "experiment=nope",
    "launcher=nope", "residual=nope", "residual.kind=rbf", "hydra=x",
    "'", '"', "a='", "\u2603=3", "estimator.horizon=3\n4", "-", "--", "---x", "--cfg", "--cfg=nope",
    "--package", "--shell-completion", "--hydra-help", "--config-path=x", "--config-name=trace",
    "--experimental-rerun=x", "--version=3", "estimator.seed=-1", "estimator.seed=99999999999999999999999",
    "sweep=1", "tune=1", "port=3", "experiments=[a]", "processes=2", "parameters.J.lower=nan",
    "parameters.J.lower=inf", "parameters.J.fixed=inf", "parameters.J.guess=1e400", "parameters.J.lower=yes",
    "parameters={K: {lower: 1}}", "parameters=3", "parameters=[]", "parameters=abc", "parameters={J: 3}",
    "parameters={J: {lower: a}}", "parameters={J: [1,2]}", "friction=nope", "paths=x", "mlflow=false",
    "mlflow.enabled=no", "mlflow.enabled=maybe", "force=no", "force=off", "force=[]", "force=3.5",
    "model=nope.json", "model=lab/swing.csv", "model=lab", "fit", "case mine", "out=[a]",
)  # fmt: skip
"""Added to a fit that is right, each to be refused."""
ODD_WORDS = (
    "estimator.horizon=", "estimator.horizon=''", "estimator=null", "effects.0=coulomb",
    "estimator.horizon=\t", "+residual={kind: rbf}", "friction=dahl",
    "launcher=joblib", "launcher=slurm", "paths={}", "mlflow={}",
    "mlflow=null", "paths=null", "fit=null", "validate=null", "trace=null", "hydra/launcher=joblib", "a=b=c",
    "hydra.sweeper=x", "estimator={horizon: 10}", "+residual={}",
    "-m", "--multirun", "--cfg=job", "--info", "--info=all", "--resolve", "--package=x", "--run", "-r",
    "experiment=emps_rbf", "residual={kind: rbf}", "parameters=null", "parameters={}", "parameters={J: null}",
    "parameters={J: {fixed: null}}", "parameters={J: {lower: 0.01, upper: 0.1}}", "parameters.J.fixed=0",
    "+parameters={J: {lower: 0.02}}", "~parameters", "hydra.run.dir=x", "parameters.G.lower=-1e308",
    "parameters.G.upper=-1e308", "parameters.G.guess=-1e308", "parameters.G.fixed=-1e308",
)  # fmt: skip
CONFIGURED = (
    "run", "preprocess", "fit", "residual", "validate", "plot", "sweep", "trace", "fetch", "tune", "log",
    "reproduce", "ui",
)  # fmt: skip
LISTS = ("cases", "effects", "completion", "trust")
STRANGE = ("garbage", "x=3", "--nope", "case=nope", "x" * 3000)

BARE: tuple[tuple[str, ...], ...] = (
    ("effects", "nope"), ("effects", "cable:CABLE"), ("effects", "a:b:c"), ("effects", ":"), ("effects", ""),
    ("effects", "os:path"), ("cases", "nope"), ("cases", "--config-dir"), ("cases", "--config-dir", "nope"),
    ("completion", "nope"), ("help", "nope"), ("nope",), ("",), ("--nope",), ("fetch", "emps,esea"),
    ("fetch", "mine", "--config-dir", "lab"), ("fetch", "case=emps", "archive.url=ftp://x"),
    ("fetch", "case=emps", "archive.url=file:///etc/passwd"), ("fetch", "case=emps", "archive.name=nope"),
    ("fetch", "case=emps", "archive.url=http://127.0.0.1:9/x"), ("fetch", "case=emps", "archive.url=http://"),
    ("fetch", "case=emps", "archive.url=http://[::1"),
    ("fetch", "case=emps", "archive.url='http://exa mple/ '"), ("ui", "port=99999"), ("ui", "port=abc"),
    ("sweep", *OWN, "estimator.horizon=10,20", "x=1"),
    ("sweep", *OWN, "estimator.horizon=interval(1,3)"), ("sweep", *OWN, "estimator.horizon=range(1,0)"),
    ("sweep", *OWN, "estimator.horizon=choice()"), ("sweep", *OWN, "effects=[viscos],[viscous]"),
    ("sweep", *OWN, "estimator.horizon=a,b"), ("fit", "-m", *OWN, "estimator.horizon=20,abc"),
    ("tune", *OWN), ("tune", *OWN, "residual=narx", "tune.space=3"),
    ("tune", *OWN, "residual=narx", "tune.space={nope: {low: 1, high: 2}}"),
    ("tune", *OWN, "residual=narx", "tune.space={residual: {width: {low: 5, high: 2}}}"),
    ("tune", *OWN, "residual=narx", "tune.space={residual: {width: {low: a, high: b}}}"),
    ("tune", *OWN, "residual=narx", "tune.trials=0"), ("reproduce", "experiments=[nope]"),
    ("reproduce", "experiments=[]"), ("reproduce", "experiments=3"), ("reproduce", "processes=0"),
    ("trace", *OWN, "trace.effects=[nope]"), ("trace", *OWN, "trace.ports=[nope]"),
    ("trace", *OWN, "trace.extra_effects=[nope]"), ("trace", *OWN, "trace.horizon=0.001"),
    ("validate", *OWN, "validate.horizon=1e-9"), ("residual", *OWN),
    ("residual", *OWN, "residual=rbf", "residual.port=nope"),
    ("residual", *OWN, "residual=narx", "residual.outputs=[nope]"),
    ("residual", *OWN, "residual=narx", "residual.orders={error: 1000, inputs: 1, gray: 1}"),
    ("residual", *OWN, "residual=narx", "residual.orders={error: 1, inputs: {nope: 3}, gray: 1}"),
    ("residual", *OWN, "residual=narx", "residual.every=1000"),
)  # fmt: skip
ODD_BARE: tuple[tuple[str, ...], ...] = (
    ("sweep", *OWN), ("log", "paths.outputs=lab/swing.csv"), ("log", "mlflow.tracking_uri=nope://x"),
    ("completion", "bash"), ("completion",), ("help",), ("log",), ("log", "paths.outputs=nowhere"),
    ("trace", *OWN, "trace.horizon=100"), ("validate", *OWN, "validate.horizon=1e9"),
    ("validate", *OWN, "validate.lags=100000"),
)  # fmt: skip

STEPS = (
    "{step: butterworth, signals: [angle], order: 0, cutoff: 1}",
    "{step: butterworth, signals: [angle], order: 4, cutoff: 1000}",
    "{step: butterworth, signals: [angle], order: 400, cutoff: 1}",
    "{step: butterworth, signals: [nope], order: 4, cutoff: 1}",
    "{step: butterworth, signals: [], order: 4, cutoff: 1}", "{step: crop, start: 5}",
    "{step: crop, start: 2, stop: 1}", "{step: crop, samples: [5]}", "{step: crop, samples: [a,b]}",
    "{step: decimate, factor: 0}", "{step: decimate, factor: 1000}", "{step: decimate, factor: 1.5}",
    "{step: decimate, factor: a}", "{step: differentiate}", "{step: offset, signals: [angle], value: nan}",
    "{step: scale, signals: [angle], factor: 0}", "{step: scale, signals: [angle], factor: inf}",
    "{step: remove_mean}", "{step: savitzky_golay, signals: [angle], window: 4, order: 9}",
    "{step: savitzky_golay}", "{step: nope}", "{}", "{step: }", "3", "a",
)  # fmt: skip
ODD_STEPS = (
    "{step: crop, samples: [0, 5]}", "{step: crop, samples: [-5, 1000]}",
    "{step: differentiate, signal: angle}", "{step: integrate, signal: angle}",
    "{step: offset, signal: angle}", "{step: remove_mean, signals: [angle]}",
    "{step: scale, signals: [angle], factor: 1e300}",
)  # fmt: skip


def cases() -> Iterator[tuple[str, Case]]:
    """Each with its category."""
    for words, codes in chain(_lines(REFUSED, WORDS, BARE), _lines(BORNE, ODD_WORDS, ODD_BARE)):
        ours = set(OWN) <= set(words)
        own = " ".join(word for word in words if not ours or word not in OWN)
        yield "requests", Case(f"request{' about the lab' * ours}: {own!r}"[:200], tuple(words), (), codes)
    for command, word in (*product(CONFIGURED, STRANGE), *product(LISTS, STRANGE[2:])):
        yield "requests", Case(f"request: {command!r} {word!r}"[:200], (command, word))
    for step, codes in (*product(STEPS, (REFUSED,)), *product(ODD_STEPS, (BORNE,))):
        words = tuple(fit(f"preprocess.steps=[{step}]", command="preprocess"))
        yield "preprocessing steps", Case(f"step {step}", words, (), codes)


def _lines(
    codes: tuple[int, ...], words: Sequence[str], bare: Sequence[Sequence[str]]
) -> Iterator[tuple[Sequence[str], tuple[int, ...]]]:
    """Whole command lines, with the exit codes that are right."""
    yield from ((fit(word), codes) for word in words)
    yield from ((line, codes) for line in bare)
