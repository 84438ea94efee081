"""Model files as a colleague may mail them, with code beside them that nobody asked for."""

from __future__ import annotations

import json
import sysconfig
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path
from typing import Any

from benchmarks.torture.case import BORNE, Content
from benchmarks.torture.commands import NETWORK, SPACE, WIDTHS
from benchmarks.torture.tables.decoys import DECOY, LINE, SHELL, Trap, compiled, pickled

QUICK = ("case=emps", "data=simulated", "rig.duration=1.2", "mlflow.enabled=false", "out=tree")
MODEL = "model=theirs/model.json"
TAKE: Mapping[str, tuple[str, ...]] = {
    "preprocess": (),
    "fit": (),
    "residual": NETWORK,
    "validate": (),
    "plot": ("plot.formats=[svg]",),
    "trace": ("trace.effects=[stribeck]", "trace.processes=1"),
    "run": ("plot.formats=[svg]",),
    "sweep": (*WIDTHS, "sweep.processes=1"),
    "tune": (*NETWORK, *SPACE),
}
"""The commands that take up a model, with what makes them quick."""


def model(folders: tuple[str, ...] = ("{theirs}",), **config: Any) -> Callable[[Path], None]:
    """Writes a model.json of the EMPS with other keys in its config; "{theirs}" is the folder it lies in."""

    def write(path: Path) -> None:
        theirs = path.parent.resolve()
        content = {
            "case": "emps",
            "config": {
                "plant": "hybridid.plants.emps:EMPS",
                "channels": None,
                "effects": ["viscous", "coulomb"],
                "parameters": {},
                **config,
            },
            "python_folders": [
                folder.replace("{theirs}", str(theirs)).replace("{here}", theirs.parent.name)
                for folder in folders
            ],
            "states": [],
            "inputs": [],
            "outputs": [],
            "terms": [],
            "provenance": "measured",
        }
        path.write_text(json.dumps(content), encoding="utf-8")

    return write


def _bytecode(path: Path) -> None:
    """Bytecode of the decoy that claims to be that of the sound source beside it."""
    import importlib._bootstrap_external as external

    source = path.parent.parent / "theirs_plant.py"
    about = source.stat()
    code = compile(DECOY, str(source), "exec")
    path.write_bytes(external._code_to_timestamp_pyc(code, int(about.st_mtime), about.st_size))


EXTENSION = "theirs_plant" + sysconfig.get_config_var("EXT_SUFFIX")
PYC = f"theirs/__pycache__/theirs_plant.{sysconfig.get_config_var('SOABI').rpartition('-x86')[0]}.pyc"
THEIRS = {"theirs/theirs_plant.py": DECOY}
NAMED = "theirs_plant:PLANT"
JSON = "theirs/model.json"
TRUST = ("trust", "theirs")


FOLDERS = (
    "./theirs/../theirs", "theirs/../../{here}/theirs", "/proc/self/cwd/theirs", "theirs/.", "/{theirs}",
)  # fmt: skip


def _traps() -> Iterator[Trap]:
    yield Trap("a plant in its folder", {**THEIRS, JSON: model(plant=NAMED)}, says=("trust",))
    yield Trap("a plant in a relative folder", {**THEIRS, JSON: model(("theirs",), plant=NAMED)})
    for folder in FOLDERS:
        named = {**THEIRS, JSON: model((folder,), plant=NAMED)}
        yield Trap(f"a plant in {folder}", named)
    linked = {"linked": lambda path: path.symlink_to(path.parent / "theirs", target_is_directory=True)}
    yield Trap("a plant behind a link", {**THEIRS, JSON: model(("linked",), plant=NAMED), **linked})
    yield Trap("an effect", {**THEIRS, JSON: model(effects=["theirs_plant:EFFECT"])}, says=("trust",))
    yield Trap("an effect at a port", {**THEIRS, JSON: model(effects=["theirs_plant:EFFECT@carriage"])})
    yield Trap("a rig", {**THEIRS, JSON: model(rig={"path": "theirs_plant:EMPSRig"})}, codes=BORNE)
    yield Trap("an effect to try", {**THEIRS, JSON: model(trace={"extra_effects": [NAMED]})}, codes=BORNE)
    yield Trap("code beside the file, no folder", {**THEIRS, JSON: model((), plant=NAMED)})
    yield Trap("code where one stands", {"theirs_plant.py": DECOY, JSON: model((), plant=NAMED)})
    yield Trap("the folder where one stands", {"theirs_plant.py": DECOY, JSON: model((".",), plant=NAMED)})
    yield Trap("a package", {"theirs/theirs_plant/__init__.py": DECOY, JSON: model(plant=NAMED)})
    part = {"theirs/pack/__init__.py": LINE, "theirs/pack/part.py": DECOY}
    yield Trap("a part of a package", {**part, JSON: model(plant="pack.part:PLANT")})
    yield Trap("machine code", {f"theirs/{EXTENSION}": compiled, JSON: model(plant=NAMED)})
    for name in ("matplotlib", "numpy", "json", "casadi"):
        files = {f"theirs/{name}.py": DECOY, JSON: model(plant=f"{name}:PLANT")}
        yield Trap(f"a module called {name}", files)
    files = {"theirs/hybridid/decoy.py": DECOY, JSON: model(plant="hybridid.decoy:PLANT")}
    yield Trap("a part of hybridid that there is not", files, codes=BORNE)
    for path in ("os:system", "builtins:exec", "subprocess:run", "antigravity:x", "pip.__main__:main"):
        yield Trap(f"{path} as a plant", {JSON: model(plant=path)})
        yield Trap(f"{path} as an effect", {JSON: model(effects=[path])})
    yield Trap("a case file beside it", {**THEIRS, **_their_case(), JSON: model((), plant=NAMED)})
    tagged = f"!!python/object/apply:os.system ['{SHELL}']\n"
    yield Trap("YAML with a tag of Python", {JSON: tagged})
    yield Trap("a pickle", {JSON: pickled})
    yield Trap("a line that steers the terminal", {**THEIRS, JSON: model(("\x1b[2J",), plant=NAMED)})
    yield from _trusted()


def _trusted() -> Iterator[Trap]:
    """Trust holds for the code as it was, and only if nobody else could have written it down."""
    whole = {**THEIRS, JSON: model(plant=NAMED)}
    no_code = f"{DECOY}\n"
    changes: Mapping[str, Mapping[str, Content]] = {
        "then changed by a byte": {"theirs/theirs_plant.py": no_code},
        "then a file comes": {"theirs/numpy.py": LINE},
        "then a folder comes": {"theirs/sub/more.py": LINE},
        "then machine code comes": {f"theirs/{EXTENSION}": compiled},
    }
    for what, changed in changes.items():
        yield Trap(f"trusted, {what}", whole, (TRUST,), changed, says=("trust",))
    opened = {".config/hybridid/trusted": lambda path: path.chmod(0o777)}
    yield Trap("trusted, where others may write", whole, (TRUST,), opened, says=("not read",))
    another = {"other/theirs_plant.py": DECOY, **whole}
    yield Trap("another folder trusted", {**another, "other/more.py": ""}, (("trust", "other"),))
    sound = {"theirs/theirs_plant.py": DECOY.replace(LINE, ""), JSON: model(plant=NAMED)}
    yield Trap("trusted, bytecode of another source", {**sound, PYC: _bytecode}, (TRUST,), codes=BORNE)
    yield Trap("control: trusted", whole, (TRUST,), codes=BORNE, runs=True)


def _their_case() -> dict[str, Content]:
    text = f"# @package _global_\ncase: {{title: theirs}}\nplant: {NAMED}\n"
    return {"theirs/case/emps.yaml": text, "theirs/fit.yaml": text, "theirs/case/theirs.yaml": text}


TRAPS = tuple(_traps())
"""What a model file may bring."""
