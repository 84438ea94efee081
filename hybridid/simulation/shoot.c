/* Simulates horizons, LANES a group and TURNS groups at a time, by two parts of a model: `advance`, one step of the
   state and its sensitivities, and `observe`, the outputs and theirs (it ignores h). */
#include <stdlib.h>
#include <string.h>

/* Samples between two looks at what was spent. */
#define OFTEN 32

/* What is to be simulated. Blocks of groups, the horizons' `length`, steps a sample, states, columns of sensitivities (0: none),
   inputs, stage inputs a sample, stage inputs from one step to the next, outputs. `members`: the horizons of each
   block, -1 where a lane is left over; a block comes after those of the horizons that its own follow. `follows`: the
   horizon before each, or -1; `lengths`: samples of each that are its own. `measured`: what the outputs are compared
   with, `weights`: what the difference r is multiplied by, 0 where it does not count, or NULL for no comparison.
   `limit`: the sum of r'r above which the simulation may stop, or infinity. */
typedef struct {
  long long blocks, length, steps, n_x, n_s, n_u, n_stage, hop, n_y;
  const long long *members, *follows, *lengths, *carried;
  double h, limit;
  const double *time, *stages, *inputs, *p, *x0, *measured, *weights;
} Task;

/* `final`: the state one sample after the last; `ends`: state and sensitivities after each horizon's own samples. A
   horizon that leaves the numbers is blank from there on. Without a comparison: `final`, `states`, `outputs` and maybe
   `slopes`. With one: of each horizon r'r in `spent` and maybe, of the slopes J of the weighted outputs, J'J in `square`
   and J'r in `error`. The others are NULL. */
typedef struct {
  double *final, *states, *outputs, *slopes, *ends, *spent, *square, *error;
} Result;

/* A group under way: the horizon of each lane, which lanes still have one within the numbers, and which had samples that
   count when they left them (-1: a lane left over). `by`: the sensitivities of `now`. `column`: those of one weighted
   output. */
typedef struct {
  long long own[LANES];
  int alive[LANES], lost[LANES];
  Lanes *now, *next, *y, *u, *stage, *measured, *weights, spent;
  Slope *by, *next_by, *y_by, *column, *square, *error;
} Group;

/* Room that so many columns of n rows take. */
static long long slopes(long long n, long long columns) { return (columns + BESIDE - 1) / BESIDE * n; }

static void blank(double *a, long long n) {
  for (long long k = 0; k < n; ++k) a[k] = NAN;
}

static int is_finite(const double *a, long long n) {
  for (long long k = 0; k < n; ++k)
    if (!isfinite(a[k])) return 0;
  return 1;
}

static void take(double *to, const Lanes *from, int lane, long long n) {
  for (long long k = 0; k < n; ++k) to[k] = AT(from[k], lane);
}

/* Of a matrix of n rows, one column after another. */
static void take_slopes(double *to, const Slope *from, int lane, long long n, long long columns) {
  for (long long j = 0; j < columns; ++j)
    for (long long r = 0; r < n; ++r) *to++ = SLOPE(from, n, r, j, lane);
}

static void take_end(double *to, const Group *g, const Task *task, int lane) {
  take(to, g->now, lane, task->n_x);
  take_slopes(to + task->n_x, g->by, lane, task->n_x, task->n_s);
}

/* The numbers of sample `at` of each lane, n of `from` a sample. */
static void put(Lanes *to, const Group *g, const Task *task, const double *from, long long sample, long long n) {
  const double *own[LANES];
  for (int l = 0; l < LANES; ++l) own[l] = from + (g->own[l] * task->length + sample) * n;
  for (long long k = 0; k < n; ++k) to[k] = (Lanes)OF_EACH(own, k);
}

/* Each horizon begins at its x0. Of one that follows another, the states marked in `carried` are what they were where
   that one ended, if it did not leave the numbers. A lane that is left over does what `spare` does. */
static void begin(Group *g, const Task *task, const Result *found, const long long *members, long long spare) {
  const long long n_x = task->n_x, n = n_x * (1 + task->n_s);
  memset(g->by, 0, slopes(n_x, task->n_s) * sizeof(Slope));
  if (found->square) {
    memset(g->square, 0, slopes(task->n_s, task->n_s) * sizeof(Slope));
    memset(g->error, 0, slopes(1, task->n_s) * sizeof(Slope));
  }
  g->spent = (Lanes)FILL(0.0);
  for (int l = 0; l < LANES; ++l) {
    const long long w = members[l] >= 0 ? members[l] : spare, before = task->follows[w];
    const double *end = found->ends + before * n;
    const int handed_on = before >= 0 && is_finite(end, n_x);
    for (long long i = 0; i < n_x; ++i)
      AT(g->now[i], l) = handed_on && task->carried[i] ? end[i] : task->x0[w * n_x + i];
    for (long long j = 0; j < n_x && j < task->n_s; ++j) SLOPE(g->by, n_x, j, j, l) = 1.0;
    g->own[l] = w;
    g->lost[l] = members[l] < 0 ? -1 : 0;
    g->alive[l] = members[l] >= 0;
    if (g->alive[l]) blank(found->ends + w * n, n);
  }
}

/* A lane has just left the numbers, before `sample`: it is blank from there on. */
static void leave(Group *g, const Task *task, const Result *found, long long sample, int lane) {
  const long long left = task->length - sample, n_y = task->n_y, at = g->own[lane] * task->length + sample;
  g->alive[lane] = 0;
  if (task->weights) {
    for (long long i = 0; i < left * n_y; ++i) g->lost[lane] |= task->weights[at * n_y + i] != 0.0;
    return;
  }
  blank(found->states + at * task->n_x, left * task->n_x);
  blank(found->outputs + at * n_y, left * n_y);
  if (found->slopes) blank(found->slopes + at * task->n_s * n_y, left * task->n_s * n_y);
  blank(found->final + g->own[lane] * task->n_x, task->n_x);
}

/* Whether any lane is still within the numbers. */
static int still_alive(Group *g, const Task *task, const Result *found, long long sample) {
  int any = 0;
  Lanes zero = FILL(0.0);
  for (long long i = 0; i < task->n_x; ++i) zero += FILL(0.0) * g->now[i];
  for (int l = 0; l < LANES; ++l) {
    if (g->alive[l] && AT(zero, l) != 0.0) leave(g, task, found, sample, l);
    any |= g->alive[l];
  }
  return any;
}

static void store(const Group *g, const Task *task, const Result *found, long long sample) {
  const long long n_slopes = task->n_s * task->n_y;
  for (int l = 0; l < LANES; ++l) {
    const long long at = g->own[l] * task->length + sample;
    if (!g->alive[l]) continue;
    take(found->states + at * task->n_x, g->now, l, task->n_x);
    take(found->outputs + at * task->n_y, g->y, l, task->n_y);
    if (found->slopes) take_slopes(found->slopes + at * n_slopes, g->y_by, l, task->n_y, task->n_s);
  }
}

/* Adds what the outputs of sample k give to r'r and to the products, of which half is kept: column j up to its own row. */
static void weigh(Group *g, const Task *task, long long k) {
  const long long n_y = task->n_y, n_s = task->n_s, blocks = slopes(1, n_s);
  put(g->measured, g, task, task->measured, k, n_y);
  put(g->weights, g, task, task->weights, k, n_y);
  for (long long r = 0; r < n_y; ++r) {
    const Lanes weight = g->weights[r], error = (g->measured[r] - g->y[r]) * weight;
    g->spent += ONLY_IF(weight, error * error);
    const Slope left = COUNTED(weight, SPREAD(error));
    for (long long b = 0; b < blocks; ++b)
      g->column[b] = COUNTED(weight, g->y_by[b * n_y + r] * SPREAD(weight));
    for (long long j = 0; j < n_s; ++j) {
      const Slope own = COLUMN(g->column, j);
      Slope *square = g->square + j * blocks;
      for (long long b = 0; b * BESIDE <= j; ++b) square[b] += own * g->column[b];
    }
    for (long long b = 0; b < blocks; ++b) g->error[b] += left * g->column[b];
  }
}

/* What a lane spent; nothing, if it left the numbers while samples counted. */
static double spent_by(const Group *g, int lane) { return g->lost[lane] ? NAN : AT(g->spent, lane); }

/* Whether all lanes together have spent more than the limit, beside what was spent before. */
static int too_much(const Group *g, int groups, const Task *task, double before) {
  if (isinf(task->limit)) return 0;
  for (int a = 0; a < groups; ++a)
    for (int l = 0; l < LANES; ++l)
      if (g[a].lost[l] >= 0) before += spent_by(g + a, l);
  return !(before <= task->limit);
}

static void take_products(const Group *g, const Task *task, const Result *found, int lane) {
  const long long n_s = task->n_s, blocks = slopes(1, n_s);
  double *square = found->square + g->own[lane] * n_s * n_s, *error = found->error + g->own[lane] * n_s;
  if (g->lost[lane]) {
    blank(square, n_s * n_s);
    blank(error, n_s);
    return;
  }
  for (long long j = 0; j < n_s; ++j) {
    error[j] = SLOPE(g->error, 1, 0, j, lane);
    for (long long i = 0; i <= j; ++i)
      square[j * n_s + i] = square[i * n_s + j] = SLOPE(g->square + j * blocks, 1, 0, i, lane);
  }
}

/* The sample k of each lane's record, and the outputs there. */
static void observed(Group *g, const Task *task, const Result *found, Place *at, long long k) {
  put(&at->t, g, task, task->time, k, 1);
  put(g->u, g, task, task->inputs, k, task->n_u);
  put(g->stage, g, task, task->stages, k, task->n_stage);
  at->x = g->now, at->s = g->by, at->u = g->u, at->value = g->y, at->slope = g->y_by;
}

/* From `now` to `next`, step i of the sample. */
static void stepped(Group *g, const Task *task, Place *at, long long i) {
  Lanes *now = g->now;
  Slope *by = g->by;
  at->x = now, at->s = by, at->u = g->stage + i * task->hop, at->value = g->next, at->slope = g->next_by;
  g->now = g->next, g->next = now;
  g->by = g->next_by, g->next_by = by;
}

/* Returns whether it stopped as too much was spent, with `before`. */
static int run(Group *g, int groups, const Task *task, const Result *found, const Part *advance, const Part *observe,
               const double *known, double before) {
  const long long n_x = task->n_x, n = n_x * (1 + task->n_s);
  Place at[TURNS] = {0};
  for (long long k = 0; k < task->length; ++k) {
    int any = 0;
    for (int a = 0; a < groups; ++a) any |= still_alive(g + a, task, found, k);
    if (!any) break;
    for (int a = 0; a < groups; ++a) observed(g + a, task, found, at + a, k);
    observe->run(at, groups, task->h, task->p, known + advance->constants, task->n_s);
    for (int a = 0; a < groups; ++a) task->weights ? weigh(g + a, task, k) : store(g + a, task, found, k);
    if (k % OFTEN == 0 && too_much(g, groups, task, before)) return 1;
    for (long long i = 0; i < task->steps; ++i) {
      for (int a = 0; a < groups; ++a) stepped(g + a, task, at + a, i);
      advance->run(at, groups, task->h, task->p, known, task->n_s);
      for (int a = 0; a < groups; ++a) at[a].t += task->h;
    }
    for (int a = 0; a < groups; ++a)
      for (int l = 0; l < LANES; ++l)
        if (g[a].alive[l] && k + 1 == task->lengths[g[a].own[l]])
          take_end(found->ends + g[a].own[l] * n, g + a, task, l);
  }
  for (int a = 0; a < groups; ++a)
    for (int l = 0; l < LANES; ++l)
      if (found->final && g[a].alive[l]) take(found->final + g[a].own[l] * n_x, g[a].now, l, n_x);
  for (int a = 0; found->spent && a < groups; ++a)
    for (int l = 0; l < LANES; ++l)
      if (g[a].lost[l] >= 0) {
        found->spent[g[a].own[l]] = spent_by(g + a, l);
        if (found->square) take_products(g + a, task, found, l);
      }
  return too_much(g, groups, task, before);
}

/* Bytes that begin and end on a cache line, with one to spare. */
static size_t rounded(size_t bytes) { return (bytes / 64 + 2) * 64; }

/* Groups of a block that have a horizon: the first ones. */
static int groups_of(const long long *members) {
  int groups = 1;
  while (groups < TURNS && members[groups * LANES] >= 0) ++groups;
  return groups;
}

/* Rooms of a group, one after another in what is freed at the end; returns it, or NULL without memory. */
static void *make_room(Group *g, const Task *task) {
  const long long n_x = task->n_x, n_y = task->n_y, n_s = task->n_s, by = slopes(n_x, n_s), blocks = slopes(1, n_s);
  const long long lanes[] = {n_x, n_x, n_y, task->n_u, task->n_stage, n_y, n_y};
  const long long columns[] = {by, by, slopes(n_y, n_s), blocks, n_s * blocks, blocks};
  Lanes **own[] = {&g->now, &g->next, &g->y, &g->u, &g->stage, &g->measured, &g->weights};
  Slope **own_by[] = {&g->by, &g->next_by, &g->y_by, &g->column, &g->square, &g->error};
  size_t size = 0;
  for (int k = 0; k < 7; ++k) size += rounded(lanes[k] * sizeof(Lanes));
  for (int k = 0; k < 6; ++k) size += rounded(columns[k] * sizeof(Slope));
  char *all = aligned_alloc(64, size), *at = all;
  for (int k = 0; all && k < 7; ++k) *own[k] = (Lanes *)at, at += rounded(lanes[k] * sizeof(Lanes));
  for (int k = 0; all && k < 6; ++k) *own_by[k] = (Slope *)at, at += rounded(columns[k] * sizeof(Slope));
  return all;
}

/* Returns 0, 1 without memory, or 2 if it stopped as more than the limit was spent. */
int shoot(const Part *advance, const Part *observe, const Task *task, const Result *found) {
  Group g[TURNS];
  void *rooms[TURNS];
  double *known = malloc((advance->constants + observe->constants + 1) * sizeof *known);
  int ready = known != NULL, stopped = 0;
  double before = 0.0;
  for (int a = 0; a < TURNS; ++a) {
    rooms[a] = make_room(g + a, task);
    ready = ready && rooms[a];
  }
  if (ready) {
    advance->prepare(task->h, task->p, known);
    observe->prepare(task->h, task->p, known + advance->constants);
  }
  for (long long k = 0; ready && !stopped && k < task->blocks; ++k) {
    const long long *members = task->members + k * TURNS * LANES;
    const int groups = groups_of(members);
    for (int a = 0; a < groups; ++a) begin(g + a, task, found, members + a * LANES, members[0]);
    stopped = run(g, groups, task, found, advance, observe, known, before);
    for (int l = 0; found->spent && !stopped && l < TURNS * LANES; ++l)
      if (members[l] >= 0) before += found->spent[members[l]];
  }
  for (int a = 0; a < TURNS; ++a) free(rooms[a]);
  free(known);
  return !ready ? 1 : stopped ? 2 : 0;
}
