/* Simulates horizons, one after another, by two functions that CasADi has written of a model: `advance`, one step of
   the state and its sensitivities, and `observe`, the outputs and theirs (it ignores h). Without sensitivities they
   give the first of their results only. Matrices lie column by column, as CasADi has them. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

typedef long long casadi_int;
typedef int (*Function)(const double **arg, double **res, casadi_int *iw, double *w, int memory);

static void run(Function call, const double *x, const double *s, const double *t, const double *h, const double *u,
                const double *p, double *value, double *slope) {
  const double *arg[] = {x, s, t, h, u, p};
  double *res[] = {value, slope};
  call(arg, res, NULL, NULL, 0);
}

static void blank(double *a, casadi_int n) {
  for (casadi_int k = 0; k < n; ++k) a[k] = NAN;
}

static int is_finite(const double *a, casadi_int n) {
  for (casadi_int k = 0; k < n; ++k)
    if (!isfinite(a[k])) return 0;
  return 1;
}

/* Where a horizon begins that follows another: the states marked in `carried` are what they were where that one
   ended, if it did not leave the numbers. */
static void carry_on(double *now, const double *end, const casadi_int *carried, casadi_int n_x) {
  if (!is_finite(end, n_x)) return;
  for (casadi_int i = 0; i < n_x; ++i)
    if (carried[i]) now[i] = end[i];
}

/* size: horizons, their length, steps a sample, states, columns of sensitivities (0: none), inputs,
   stage inputs a sample, stage inputs from one step to the next, outputs. `follows`: the horizon before each, or
   -1; `lengths`: samples of each that are its own; `ends`: its state and sensitivities after these. A horizon that
   leaves the numbers is blank from there on. Returns 0, or 1 without memory. */
int shoot(Function advance, Function observe, const casadi_int *size, const casadi_int *follows,
          const casadi_int *lengths, const casadi_int *carried, double h, const double *time, const double *stages,
          const double *inputs, const double *p, const double *x0, double *final, double *states, double *outputs,
          double *slopes, double *ends) {
  const casadi_int count = size[0], length = size[1], steps = size[2], n_x = size[3], n_s = size[4];
  const casadi_int n_u = size[5], n_stage = size[6], hop = size[7], n_y = size[8];
  const casadi_int n = n_x * (1 + n_s);
  double *now = malloc(n * sizeof *now), *next = malloc(n * sizeof *next);
  const int ready = now && next;
  for (casadi_int w = 0; ready && w < count; ++w) {
    memset(now, 0, n * sizeof *now);
    memcpy(now, x0 + w * n_x, n_x * sizeof *now);
    for (casadi_int j = 0; j < n_x && j < n_s; ++j) now[n_x + j * n_x + j] = 1.0;
    if (follows[w] >= 0) carry_on(now, ends + follows[w] * n, carried, n_x);
    blank(ends + w * n, n);
    for (casadi_int k = 0; k < length; ++k) {
      const casadi_int at = w * length + k;
      if (!is_finite(now, n_x)) {
        blank(states + at * n_x, (length - k) * n_x);
        blank(outputs + at * n_y, (length - k) * n_y);
        if (n_s) blank(slopes + at * n_s * n_y, (length - k) * n_s * n_y);
        blank(now, n_x);
        break;
      }
      memcpy(states + at * n_x, now, n_x * sizeof *now);
      run(observe, now, now + n_x, time + at, &h, inputs + at * n_u, p, outputs + at * n_y,
          slopes + at * n_s * n_y);
      for (casadi_int i = 0; i < steps; ++i) {
        const double t = time[at] + i * h;
        double *swap = now;
        run(advance, now, now + n_x, &t, &h, stages + at * n_stage + i * hop, p, next, next + n_x);
        now = next, next = swap;
      }
      if (k + 1 == lengths[w]) memcpy(ends + w * n, now, n * sizeof *now);
    }
    memcpy(final + w * n_x, now, n_x * sizeof *now);
  }
  free(now), free(next);
  return !ready;
}
