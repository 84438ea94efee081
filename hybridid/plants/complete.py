"""Whether a plant declares all that a model needs, checked before it is asked for its equations."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from hybridid.blame import blame
from hybridid.declarations import Parameter, Port, Signal, State
from hybridid.naming import unknown
from hybridid.plants.plant import TOGETHER, Plant

_DECLARED: Mapping[str, type] = {
    "states": State,
    "inputs": Signal,
    "outputs": Signal,
    "parameters": Parameter,
    "ports": Port,
}


def check_plant(plant: Plant) -> None:
    """Whether every declaration of a plant is there, of its type, and its names are good.

    Raises:
        OwnCodeError: with the plant's file and line, if not.
    """
    kind = type(plant)
    for text in ("name", "meaning", "source"):
        if not isinstance(getattr(plant, text, None), str):
            blame(kind, f"plant {kind.__name__} lacks {text}, a text")
    for what in _DECLARED:
        for complaint in complaints(plant, what, _DECLARED[what]):
            blame(kind, f"plant {plant.name}: {complaint}")
    for what in ("states", "outputs"):
        if not getattr(plant, what):
            blame(kind, f"plant {plant.name} has no {what}: at least one is needed")
    for complaint in _unknown_signals(plant):
        blame(kind, f"plant {plant.name}: {complaint}")


def _unknown_signals(plant: Plant) -> Iterator[str]:
    """What states and signal ports say of inputs and outputs that the plant does not have."""
    names = {
        "input": [signal.name for signal in plant.inputs],
        "output": [signal.name for signal in plant.outputs],
    }
    for state in plant.states:
        if state.observed_by is not None and state.observed_by not in names["output"]:
            yield unknown(f"output in observed_by of state {state.name}:", state.observed_by, names["output"])
    for port in plant.ports:
        if port.name not in names.get(port.kind, (port.name,)):
            yield unknown(
                f"{port.kind}, after which a port of that kind is named:", port.name, names[port.kind]
            )


def complaints(owner: object, what: str, kind: type) -> Iterator[str]:
    """What is wrong with the attribute ``what`` of a plant or a controller: a tuple of ``kind``."""
    given, wanted = getattr(owner, what, None), kind.__name__
    if not isinstance(given, tuple):
        found = "missing" if given is None else f"a {type(given).__name__}"
        yield f"{what} is {found}, expected a tuple, as in {what} = ({wanted}(...),)"
        return
    for one in given:
        if not isinstance(one, kind):
            yield f"{what} holds a {type(one).__name__}, expected {wanted}(...) alone"
            return
    names = [one.name for one in given]
    for name in names:
        if names.count(name) > 1:
            yield f"two of its {what} are called {name}"
        if what != "ports" and not str(name).isidentifier():
            yield f"{name!r} among its {what} is no name: letters, digits and _ only"
        if what == "ports" and (set(str(name)) & {".", "@", TOGETHER} or not name):
            yield f"port {name!r}: a name has no '.', '@' and '{TOGETHER}'"
