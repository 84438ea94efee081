"""A step or the outputs with their sensitivities as C, from the two functions of ``sensitivities.Part``.

Of several horizons side by side, one column after another is computed. Of a single horizon, several columns
are side by side (``Slope`` of ``lanes.h``).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from hybridid.simulation.c_code import c_of
from hybridid.simulation.sensitivities import Part

FORWARD, COLUMN = ("x", "t", "h", "u", "p"), ("s", "x", "t", "h")
"""What the arguments of the functions are called in C. A column takes s as s, d as x and its v_p as t."""
SLOPES = ("s", "t", "value")
"""What of a column's arguments and results holds sensitivities."""
PARTS = "\nconst Part *parts[] = {%s};\n"
"""The parts that are called, where ``ctypes`` finds them."""
GIVEN = "const Place *at, int groups, double h, const double *p, const double *c"
VALUE = """\
static void {name}_value({given}, Lanes d[TURNS][{derivatives}]) {{
  for (int a = 0; a < groups; ++a)
    {name}_forward_run(at[a].x, at[a].x, &at[a].t, h, at[a].u, p, c, at[a].value, d[a]);
}}
"""
STAGES = """\
static void {name}_value({given}, Lanes d[TURNS][{derivatives}]) {{
  static const double share[] = {{0.0, 0.5, 0.5, 1.0}};
  static const int hop[] = {{0, {hop}, {hop}, 2 * {hop}}}, fresh[] = {{1, {hop}, 0, {hop}}};
  Lanes k[TURNS][4][{rows}], y[{rows}], e[TURNS][{name}_forward_givens + 1];
  for (int i = 0; i < 4; ++i)
    for (int a = 0; a < groups; ++a) {{
      if (fresh[i]) {name}_forward_given(at[a].u + hop[i], p, c, e[a]);
      const Lanes there = at[a].t + share[i] * h;
      for (int r = 0; r < {rows}; ++r) y[r] = i ? at[a].x[r] + share[i] * h * k[a][i - 1][r] : at[a].x[r];
      {name}_forward_run(y, y, &there, h, at[a].u + hop[i], p, c, e[a], k[a][i], d[a] + i * {stage});
    }}
  for (int a = 0; a < groups; ++a)
    for (int r = 0; r < {rows}; ++r)
      at[a].value[r] = at[a].x[r] + h / 6.0 * (k[a][0][r] + 2.0 * k[a][1][r] + 2.0 * k[a][2][r] + k[a][3][r]);
}}
"""
"""A step of the classical Runge-Kutta method, as ``integrators.rk4``; ``forward`` gives a stage's rates. What
depends on the inputs alone is computed where they are not those of the stage before."""
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
  static const Slope none[{own}];
  {kept}Lanes d[TURNS][{derivatives}] __attribute__((aligned(64)));
  const double *known = c + {name}_forward_constants;
  {name}_value(at, groups, h, p, c, d);
  for (int a = 0; a < groups; ++a)
    for (long long j = 0; j * BESIDE < columns; ++j) {{
      const Slope *own = j < {bare} ? none : (const Slope *)(d[a] + {first}) + (j - {bare}) * {own_rows};
      Slope *slope = at[a].slope + j * {rows};
      {name}_column_run(d[a], at[a].s + j * {n_x}, own, h, at[a].u, p, known, slope, (Lanes *)slope);
    }}
}}
static const Part {name} = {{{name}_forward_constants + {name}_column_constants, {name}_prepare, {name}_run}};
"""


@dataclass(frozen=True)
class _Layout:
    """Where the derivatives of a part lie in d, with ``beside`` columns side by side.

    Each stage has its ``entries``, then from ``first`` on v_p, column after column. One column at a time, the
    initial states need no v_p. Several at a time, theirs are zero.
    """

    part: Part
    beside: int

    @property
    def bare(self) -> int:
        """Columns without v_p."""
        return self.part.forward.size1_in(0) if self.beside == 1 else 0

    @property
    def first(self) -> int:
        return -(-self.part.entries // self.beside) * self.beside

    @property
    def stage(self) -> int:
        """Numbers of one stage."""
        blocks = -(-(self.part.columns - self.bare) // self.beside)
        return self.first + blocks * self.part.own_rows * self.beside

    def slope(self, k: int) -> int:
        """Of number k of the derivatives that ``forward`` gives."""
        if k < self.part.entries:
            return k
        column, row = divmod(k - self.part.entries, self.part.own_rows)
        column += self.part.forward.size1_in(0) - self.bare
        block, lane = divmod(column, self.beside)
        return self.first + (block * self.part.own_rows + row) * self.beside + lane

    def entry(self, k: int) -> int:
        """Of number k of the d that ``column`` takes: of these it reads the entries only."""
        stage, entry = divmod(k, self.part.block)
        return stage * self.stage + entry

    def own(self, k: int) -> int:
        """Of number k of the v_p that ``column`` takes, in blocks of columns."""
        stage, row = divmod(k, self.part.block)
        return stage * self.stage // self.beside + row


def c_of_parts(parts: Sequence[Part], beside: int) -> str:
    """C that defines ``parts``, in this order, with ``beside`` columns side by side.

    Raises:
        Unwritten: if one has an operation that has no C here.
    """
    text = "".join(c_of_part(part, beside) for part in parts)
    return text + PARTS % ", ".join(f"&{part.name}" for part in parts)


def c_of_part(part: Part, beside: int) -> str:
    """C that defines one ``Part``.

    Raises:
        Unwritten: if it has an operation that has no C here.
    """
    layout = _Layout(part, beside)
    known = {
        "name": part.name,
        "given": GIVEN,
        "rows": part.rows,
        "derivatives": 1 if part.column is None else max(1, part.stages * layout.stage),
    }
    value = VALUE if part.stages == 1 else STAGES
    apart = part.stages > 1
    text = c_of(part.forward, FORWARD, places={"slope": layout.slope}, apart=apart) + value.format(
        **known, hop=part.hop, stage=layout.stage
    )
    if part.column is None:
        return text + WITHOUT_COLUMNS.format(**known)
    column = c_of(part.column, COLUMN, SLOPES, {"x": layout.entry, "t": layout.own})
    own = layout.own(part.column.size1_in(2) - 1) + 1
    return (
        text
        + column
        + WITH_COLUMNS.format(
            **known,
            own=own,
            own_rows=part.own_rows,
            bare=layout.bare,
            first=layout.first,
            n_x=part.forward.size1_in(0),
            kept="static _Thread_local " if beside > 1 else "",  # zero where nothing is written
        )
    )
