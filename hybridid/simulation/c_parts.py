"""A step or the outputs with their sensitivities as C, from the two functions of ``sensitivities.Part``."""

from __future__ import annotations

from collections.abc import Sequence

from hybridid.simulation.c_code import c_of
from hybridid.simulation.sensitivities import Part

FORWARD, COLUMN = ("x", "t", "h", "u", "p"), ("x", "s", "t", "h")
"""What the arguments of the functions are called in C. A column takes s as x, d as s and its v_p as t."""
PARTS = "\nconst Part *parts[] = {%s};\n"
"""The parts that are called, where ``ctypes`` finds them."""
GIVEN = "const Place *at, int groups, double h, const double *p, const double *c"
VALUE = """\
static void {name}_value({given}, Lanes d[TURNS][{derivatives}]) {{
  for (int a = 0; a < groups; ++a)
    {name}_forward_run(at[a].x, at[a].s, &at[a].t, h, at[a].u, p, c, at[a].value, d[a]);
}}
"""
STAGES = """\
static void {name}_value({given}, Lanes d[TURNS][{derivatives}]) {{
  static const double share[] = {{0.0, 0.5, 0.5, 1.0}};
  static const int hop[] = {{0, {hop}, {hop}, 2 * {hop}}};
  Lanes k[TURNS][4][{rows}], y[{rows}];
  for (int i = 0; i < 4; ++i)
    for (int a = 0; a < groups; ++a) {{
      const Lanes there = at[a].t + share[i] * h;
      for (int r = 0; r < {rows}; ++r) y[r] = i ? at[a].x[r] + share[i] * h * k[a][i - 1][r] : at[a].x[r];
      {name}_forward_run(y, y, &there, h, at[a].u + hop[i], p, c, k[a][i], d[a] + i * {block});
    }}
  for (int a = 0; a < groups; ++a)
    for (int r = 0; r < {rows}; ++r)
      at[a].value[r] = at[a].x[r] + h / 6.0 * (k[a][0][r] + 2.0 * k[a][1][r] + 2.0 * k[a][2][r] + k[a][3][r]);
}}
"""
"""A step of the classical Runge-Kutta method, as ``integrators.rk4``; ``forward`` gives a stage's rates."""
WITHOUT_COLUMNS = """\
static void {name}_run({given}, long long columns) {{
  Lanes d[TURNS][1];
  {name}_value(at, groups, h, p, c, d);
}}
static const Part {name} = {{{name}_forward_constants, {name}_forward_prepare, {name}_run}};
"""
WITH_COLUMNS = """\
static void {name}_prepare(double h, const double *p, double *c) {{
  {name}_forward_prepare(h, p, c);
  {name}_column_prepare(h, p, c + {name}_forward_constants);
}}
static void {name}_run({given}, long long columns) {{
  static const Lanes none[{own}];
  Lanes d[TURNS][{derivatives}];
  {name}_value(at, groups, h, p, c, d);
  const double *known = c + {name}_forward_constants;
  for (int a = 0; a < groups; ++a)
    for (long long j = 0; j < columns; ++j) {{
      const Lanes *own = j < {n_x} ? none : d[a] + {entries} + (j - {n_x}) * {rows};
      Lanes *slope = at[a].slope + j * {rows};
      {name}_column_run(at[a].s + j * {n_x}, d[a], own, h, own, p, known, slope, slope);
    }}
}}
static const Part {name} = {{{name}_forward_constants + {name}_column_constants, {name}_prepare, {name}_run}};
"""


def c_of_parts(parts: Sequence[Part]) -> str:
    """C that defines ``parts``, in this order.

    Raises:
        Unwritten: if one has an operation that has no C here.
    """
    return "".join(map(c_of_part, parts)) + PARTS % ", ".join(f"&{part.name}" for part in parts)


def c_of_part(part: Part) -> str:
    """C that defines one ``Part``.

    Raises:
        Unwritten: if it has an operation that has no C here.
    """
    known = {
        "name": part.name,
        "given": GIVEN,
        "rows": part.rows,
        "derivatives": 1 if part.column is None else part.column.size1_in(1),
    }
    text = c_of(part.forward, FORWARD)
    text += (
        VALUE.format(**known) if part.stages == 1 else STAGES.format(**known, hop=part.hop, block=part.block)
    )
    if part.column is None:
        return text + WITHOUT_COLUMNS.format(**known)
    return (
        text
        + c_of(part.column, COLUMN)
        + WITH_COLUMNS.format(
            **known, own=part.column.size1_in(2), n_x=part.forward.size1_in(0), entries=part.entries
        )
    )
