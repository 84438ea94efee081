"""Writes and reads a hybrid's network: ``hybrid.json``, and ``weights.npz`` for NARX; no pickles.

The files contain the values of the gray box but not its model: the caller of ``load_hybrid`` gives that.
"""

from __future__ import annotations

import json
import os
import uuid
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import asdict, replace
from pathlib import Path
from typing import Any

import numpy as np

from hybridid.hybrid.hybrid import Hybrid
from hybridid.hybrid.output_error import OutputErrorHybrid
from hybridid.hybrid.port import PortHybrid
from hybridid.model import Model
from hybridid.naming import shortened, unknown
from hybridid.plain import build
from hybridid.residuals.narx import NARX, Weights
from hybridid.residuals.rbf import RBFNetwork
from hybridid.residuals.regressors import Scaling
from hybridid.residuals.settings import Architecture

FORMAT = 1
DESCRIPTION, WEIGHTS = "hybrid.json", "weights.npz"


class HybridFileError(ValueError):
    """Raised for files that are not a hybrid of this model; the message says why."""


def save_hybrid(hybrid: Hybrid, folder: Path | str) -> Path:
    """Write ``hybrid`` into ``folder``, each file whole or not at all; returns the description's path."""
    folder = Path(folder)
    folder.mkdir(parents=True, exist_ok=True)
    if isinstance(hybrid, PortHybrid):
        description, arrays = _describe_rbf(hybrid), None
    elif isinstance(hybrid, OutputErrorHybrid):
        description, arrays = _describe_narx(hybrid)
    else:
        raise TypeError(f"no file format for a {type(hybrid).__name__}")
    if arrays is not None:
        _replace(folder / WEIGHTS, lambda path: np.savez(path, **arrays))  # type: ignore[arg-type]
    text = json.dumps({"format": FORMAT, **description}, indent=1, ensure_ascii=False) + "\n"
    return _replace(folder / DESCRIPTION, lambda path: path.write_text(text, encoding="utf-8"))


def load_hybrid(folder: Path | str, gray: Model) -> Hybrid:
    """The hybrid that ``save_hybrid`` wrote into ``folder``, around the model ``gray``.

    Raises:
        HybridFileError: if there is no hybrid, or it was made with another model.
    """
    path = Path(folder) / DESCRIPTION
    try:
        description = json.loads(path.read_text(encoding="utf-8"))
    except (OSError, ValueError) as wrong:
        raise HybridFileError(f"{path}: no hybrid that hybridid wrote") from wrong
    if not isinstance(description, dict) or description.get("format") != FORMAT:
        raise HybridFileError(f"{path}: not of format {FORMAT}, which this version reads; make it anew")
    with _as_written(path, "not as hybridid writes it"):
        lacking = sorted(set(description["physics"]) ^ {p.name for p in gray.parameters})
        if lacking:
            raise HybridFileError(f"{path}: made with another model, they differ in {', '.join(lacking)}")
        if description["kind"] not in _LOADERS:
            raise HybridFileError(f"{path}: {unknown('kind', description['kind'], _LOADERS)}")
        return _LOADERS[description["kind"]](description, Path(folder), gray)


@contextmanager
def _as_written(path: Path, trouble: str) -> Iterator[None]:
    """What a file of another shape makes go wrong, in one line: ``path`` is ``trouble``.

    Raises:
        HybridFileError: in place of any other error.
    """
    try:
        yield
    except HybridFileError:
        raise
    except Exception as wrong:  # of what somebody changed, any part may be of any type
        said = shortened(f"{type(wrong).__name__}: {wrong}", 200)
        raise HybridFileError(f"{path}: {trouble} ({said})") from wrong


def _describe_narx(hybrid: OutputErrorHybrid) -> tuple[dict[str, Any], dict[str, np.ndarray]]:
    arrays = {}
    for network in (one for one in hybrid.networks if one.members):
        layers = [zip(one.matrices, one.biases, strict=True) for one in network.members]
        for k, layer in enumerate(zip(*layers, strict=True)):
            matrices, biases = zip(*layer, strict=True)
            arrays[f"{network.output}.{k}.matrix"] = np.stack(matrices)
            arrays[f"{network.output}.{k}.bias"] = np.stack(biases)
    plain = ("output", "unit", "dt", "input_names", "limit", "seed", "records", "provenance")
    networks = [
        {
            **{name: getattr(network, name) for name in plain},
            "members": len(network.members),
            "architecture": asdict(network.architecture),
            "scaling": asdict(network.scaling),
        }
        for network in hybrid.networks
    ]
    physics = [p.name for p in hybrid.model.parameters]
    return {"kind": "narx", "physics": physics, "values": dict(hybrid.values), "networks": networks}, arrays


def _describe_rbf(hybrid: PortHybrid) -> dict[str, Any]:
    plain = {name: getattr(hybrid, name) for name in ("port", "records", "learned_from")}
    about = {
        "kind": "rbf",
        "physics": [p.name for p in hybrid.gray.parameters],
        "values": dict(hybrid.values),
    }
    return {**about, **plain, "network": asdict(hybrid.network)}


def _load_narx(description: Mapping[str, Any], folder: Path, gray: Model) -> Hybrid:
    path = folder / WEIGHTS
    with (
        _as_written(path, f"not the weights that belong to {DESCRIPTION}"),
        np.load(path, allow_pickle=False) as arrays,
    ):
        networks = tuple(_network(about, arrays, folder) for about in description["networks"])
    return OutputErrorHybrid(gray, description["values"], networks)


def _network(about: Mapping[str, Any], arrays: Mapping[str, np.ndarray], folder: Path) -> NARX:
    where = folder / DESCRIPTION
    architecture = build(Architecture, about["architecture"], f"{where}: architecture", HybridFileError)
    scaling = build(Scaling, about["scaling"], f"{where}: scaling", HybridFileError)
    names = {name: tuple(about[name]) for name in ("input_names", "records")}
    made = {"architecture": architecture, "scaling": scaling, "members": ()}
    network = NARX(**{**about, **names, **made})
    return replace(network, members=_members(network, arrays)) if about.get("members", 1) else network


def _members(network: NARX, arrays: Mapping[str, np.ndarray]) -> tuple[Weights, ...]:
    """From arrays with an axis of members, or without it, as an earlier version wrote them."""

    def layers(what: str, axes: int) -> list[np.ndarray]:
        stored = [arrays[f"{network.output}.{k}.{what}"] for k in range(network.architecture.depth + 1)]
        return [one if one.ndim > axes else one[None] for one in stored]

    pairs = zip(zip(*layers("matrix", 2), strict=True), zip(*layers("bias", 1), strict=True), strict=True)
    return tuple(Weights(matrices, biases) for matrices, biases in pairs)


def _load_rbf(description: Mapping[str, Any], folder: Path, gray: Model) -> Hybrid:
    return PortHybrid(
        gray=gray,
        values=description["values"],
        network=build(
            RBFNetwork, description["network"], f"{folder / DESCRIPTION}: network", HybridFileError
        ),
        port=description["port"],
        records=tuple(description["records"]),
        learned_from=description["learned_from"],
    )


_LOADERS: Mapping[str, Callable[[Mapping[str, Any], Path, Model], Hybrid]] = {
    "narx": _load_narx,
    "rbf": _load_rbf,
}


def _replace(path: Path, write: Callable[[Path], object]) -> Path:
    temporary = path.with_name(f".{uuid.uuid4().hex}.{path.name}")
    try:
        write(temporary)
        os.replace(temporary, path)
    finally:
        temporary.unlink(missing_ok=True)
    return path
