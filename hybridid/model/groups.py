"""Parameters that take one value for each group of records: ``f_c = sum over groups g of w_g f_c[g]``.

A fit estimates ``f_c[cold]`` and ``f_c[warm]`` in place of f_c. Each record gives the weights w_g as inputs
that stay constant: 1 for its own group and 0 for the others, so that the sum is its own group's value.
Weights between 0 and 1 give a record that belongs to none a mean of the groups.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import casadi as ca

from hybridid.declarations import Parameter, Signal
from hybridid.naming import unknown

Groups = Mapping[str, tuple[str, ...]]
"""The names of the groups, by the qualified name of the parameter."""
WEIGHT = "1"
"""Unit of a weight."""


def of_group(name: str, group: str) -> str:
    """``f_c[cold]``: the name of the value of a group, and of the input with its weight."""
    return f"{name}[{group}]"


def names_of(name: str, groups: Groups) -> tuple[str, ...]:
    """The names of the values that parameter ``name`` takes: its own, or one for each of its groups."""
    return tuple(of_group(name, group) for group in groups[name]) if name in groups else (name,)


def by_group(parameter: Parameter, groups: Groups) -> tuple[Parameter, ...]:
    """The parameter as often as it has values."""
    return tuple(parameter.renamed(name) for name in names_of(parameter.name, groups))


def weights_of(groups: Groups) -> tuple[Signal, ...]:
    """The inputs with the weights of all groups."""
    return tuple(
        Signal(each, WEIGHT, f"weight of group {group} in {name}")
        for name, some in groups.items()
        for group, each in zip(some, names_of(name, groups), strict=True)
    )


def weighted(groups: Groups, u: dict[str, ca.SX], p: Mapping[str, ca.SX]) -> dict[str, ca.SX]:
    """The sum of each parameter of ``groups`` that ``p`` holds; its weights are taken out of ``u``."""
    found = {}
    for name in groups:
        each = {one: u.pop(one) for one in names_of(name, groups)}
        if each.keys() <= p.keys():
            found[name] = sum((weight * p[one] for one, weight in each.items()), ca.SX(0))
    return found


def check_groups(groups: Groups, parameters: Sequence[Parameter]) -> None:
    """Check that each parameter of ``groups`` is one of ``parameters`` that a fit estimates, and no smoothing
    width, and that its groups have different names.

    Raises:
        ValueError: if not.
    """
    known = {p.name: p for p in parameters if not p.name.endswith(".epsilon")}
    for name, some in groups.items():
        if name not in known:
            raise ValueError(unknown("parameter that differs by group of records:", name, known))
        if known[name].fixed:
            value = f"{known[name].guess:g} {known[name].unit}"
            raise ValueError(
                f"parameter {name} is known, {value}: it is not estimated for each group of records"
            )
        if not some or len(set(some)) < len(some):
            raise ValueError(
                f"parameter {name}: give its groups of records names that differ, not {list(some)}"
            )
