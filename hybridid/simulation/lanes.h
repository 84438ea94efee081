/* Numbers side by side: lane k belongs to horizon k of a group of LANES horizons, 8, 4 or 1. Several make a vector, of
   which the compiler makes what the processor has (AVX-512, AVX2, SSE2, NEON). Each lane obeys IEEE arithmetic, so all
   processors give the same numbers. */
#include <math.h>

/* One number of a lane. */
#define AT(a, lane) (((double *)&(a))[lane])

#if LANES == 1

typedef double Lanes;
typedef long long Bits;
#define FILL(a) (a)
#define OF_EACH(a, k) (a[0][k])
#define TRUTH(a) ((double)(a))
#define WHERE(chosen, a, b) ((chosen) ? (a) : (b))
#define ONLY_IF(a, b) ((a) != 0.0 ? (b) : 0.0)
#define ABSOLUTE fabs
#define SIGNED_AS copysign
#define EXPONENTIAL exp
#define HYPERBOLIC_TANGENT tanh
#define LOGARITHM log
#define POWER pow
#define SINE sin
#define COSINE cos
#define ROOT sqrt
#define EACH(f, a) f(a)
#define EACH_OF_TWO(f, a, b) f(a, b)

#else

typedef double Lanes __attribute__((vector_size(8 * LANES)));
typedef long long Bits __attribute__((vector_size(8 * LANES)));
#define FILL(a) ((Lanes)OF_ALL(a))
#define TRUTH(a) ((Lanes)((a) & (Bits)FILL(1.0)))
#define WHERE(chosen, a, b) where(chosen, a, b)
#define ONLY_IF(a, b) ((Lanes)(((a) != FILL(0.0)) & (Bits)(b)))
#define ABSOLUTE(a) ((Lanes)((Bits)(a) & ~(Bits)FILL(-0.0)))
#define SIGNED_AS signed_as
#define EXPONENTIAL exponential
#define HYPERBOLIC_TANGENT hyperbolic_tangent
#define LOGARITHM logarithm
#define POWER power
#define SINE(a) wave(a, 0, sin)
#define COSINE(a) wave(a, 1, cos)
#define ROOT root
#define EACH(f, a) each(f, a)
#define EACH_OF_TWO(f, a, b) each_of_two(f, a, b)
#if LANES == 8
#define OF_ALL(a) {a, a, a, a, a, a, a, a}
#define OF_EACH(a, k) {a[0][k], a[1][k], a[2][k], a[3][k], a[4][k], a[5][k], a[6][k], a[7][k]}
#else
#define OF_ALL(a) {a, a, a, a}
#define OF_EACH(a, k) {a[0][k], a[1][k], a[2][k], a[3][k]}
#endif

static inline Lanes each(double (*f)(double), Lanes a) {
  for (int l = 0; l < LANES; ++l) AT(a, l) = f(AT(a, l));
  return a;
}

static inline Lanes each_of_two(double (*f)(double, double), Lanes a, Lanes b) {
  for (int l = 0; l < LANES; ++l) AT(a, l) = f(AT(a, l), AT(b, l));
  return a;
}

/* By the instruction of the processor: as exact as the C library's. */
static inline Lanes root(Lanes a) {
#if defined(__clang__)
  return __builtin_elementwise_sqrt(a);
#elif LANES == 8 && defined(__AVX512F__)
  return __builtin_ia32_sqrtpd512_mask(a, a, -1, 4);
#elif LANES == 4 && defined(__AVX__)
  return __builtin_ia32_sqrtpd256(a);
#else
  return each(sqrt, a);
#endif
}

static inline Lanes where(Bits chosen, Lanes a, Lanes b) { return (Lanes)((chosen & (Bits)a) | (~chosen & (Bits)b)); }

static inline Lanes signed_as(Lanes a, Lanes b) {
  return (Lanes)((Bits)ABSOLUTE(a) | ((Bits)b & (Bits)FILL(-0.0)));
}

/* x = n ln 2 + r, |r| <= ln(2) / 2, and exp(r) = (q + p) / (q - p), so exp(x) = 2^n (q + p) / (q - p). Adding `round`
   leaves n in the last bits of the sum. Relative error 3e-16. Source: Moshier (1992), Cephes Math Library, exp.c. */
static inline void split_exponential(Lanes x, Bits *n, Lanes *p, Lanes *q) {
  const Lanes round = FILL(6755399441055744.0); /* 1.5 * 2^52 */
  const Lanes shifted = x * 1.4426950408889634 + round, whole = shifted - round;
  const Lanes r = x - whole * 6.93145751953125e-1 - whole * 1.42860682030941723212e-6, rr = r * r;
  *n = (Bits)shifted - (Bits)round;
  *p = r * ((1.26177193074810590878e-4 * rr + 3.02994407707441961300e-2) * rr + 9.99999999999999999910e-1);
  *q = ((3.00198505138664455042e-6 * rr + 2.52448340349684104192e-3) * rr + 2.27265548208155028766e-1) * rr + 2.0;
}

static inline Lanes power_of_two(Bits n) { return (Lanes)((n + 1023) << 52); }

static inline Lanes exponential(Lanes x) {
  Bits n;
  Lanes p, q;
  x = where(x > 750.0, FILL(750.0), where(x < -750.0, FILL(-750.0), x));
  split_exponential(x, &n, &p, &q);
  const Bits half = n >> 1;
  return (q + p) / (q - p) * power_of_two(half) * power_of_two(n - half);
}

/* (exp(2 |x|) - 1) / (exp(2 |x|) + 1) from 0.625 on, below it |x| + |x|^3 P(x^2) / Q(x^2): one division for both.
   Relative error 3e-16. Source: Moshier (1992), Cephes Math Library, tanh.c. */
static inline Lanes hyperbolic_tangent(Lanes x) {
  Bits n;
  Lanes p, q;
  const Lanes z = ABSOLUTE(x), xx = x * x;
  const Bits small = z < 0.625;
  split_exponential(2.0 * where(z > 20.0, FILL(20.0), z), &n, &p, &q);
  const Lanes grown = power_of_two(n) * (q + p), kept = q - p;
  const Lanes above = ((-9.64399179425052238628e-1 * xx - 9.92877231001918586564e1) * xx - 1.61468768441708447952e3) * xx * z;
  const Lanes below = ((xx + 1.12811678491632931402e2) * xx + 2.23548839060100448583e3) * xx + 4.84406305325125486048e3;
  const Lanes ratio = where(small, above, grown - kept) / where(small, below, grown + kept);
  return signed_as(where(small, z, FILL(0.0)) + ratio, x);
}

static inline int everywhere(Bits a) {
  long long all = -1;
  for (int l = 0; l < LANES; ++l) all &= a[l];
  return all != 0;
}

/* x = 2^n m, sqrt(1/2) <= m < sqrt(2), y = m - 1, log(m) = y - y^2 / 2 + y^3 P(y) / Q(y); x is normal and positive.
   Adding `shift` makes a small integer a number. Relative error 3e-16. Source: Moshier (1992), Cephes, log.c. */
static inline Lanes logarithm_of_normal(Lanes x) {
  const Lanes shift = FILL(6755399441055744.0); /* 1.5 * 2^52 */
  const Bits halves = ((Bits)x & 0x000fffffffffffff) | 0x3fe0000000000000; /* from 1/2 to 1 */
  const Bits low = (Lanes)halves < 0.70710678118654752440;
  const Lanes n = (Lanes)((((Bits)x >> 52) - 1022 + low) + (Bits)shift) - shift;
  const Lanes y = where(low, (Lanes)halves + (Lanes)halves, (Lanes)halves) - 1.0, yy = y * y;
  const Lanes p = ((((1.01875663804580931796e-4 * y + 4.97494994976747001425e-1) * y + 4.70579119878881725854) * y +
                    1.44989225341610930846e1) * y + 1.79368678507819816313e1) * y + 7.70838733755885391666;
  const Lanes q = ((((y + 1.12873587189167450590e1) * y + 4.52279145837532221105e1) * y + 8.29875266912776603211e1) * y +
                   7.11544750618563894466e1) * y + 2.31251620126765340583e1;
  return y + (y * (yy * (p / q)) - n * 2.121944400546905827679e-4 - 0.5 * yy) + n * 0.693359375;
}

static inline Lanes logarithm(Lanes x) {
  return everywhere((x >= 1e-300) & (x <= 1e300)) ? logarithm_of_normal(x) : EACH(log, x);
}

/* exp(b log(a)), with a relative error of 3e-16 times 1 + |b log(a)|; by the C library where a lane has a zero, a
   negative base or a result beyond the range. */
static Lanes power(Lanes a, Lanes b) {
  if (everywhere((a >= 1e-300) & (a <= 1e300))) {
    const Lanes x = b * logarithm_of_normal(a);
    if (everywhere(ABSOLUTE(x) < 700.0)) return exponential(x);
  }
  return EACH_OF_TWO(pow, a, b);
}

/* sin(x + quarter pi / 2) with x = n pi / 2 + r, |r| <= pi / 4; by the C library, `exact`, where a lane is large. pi / 2
   is the sum of three numbers of which n times the first two is exact. Absolute error 2e-16. Source: Moshier (1992),
   Cephes Math Library, sin.c. */
static Lanes wave(Lanes x, long long quarter, double (*exact)(double)) {
  const Lanes round = FILL(6755399441055744.0); /* 1.5 * 2^52 */
  if (!everywhere(ABSOLUTE(x) < 1e6)) return EACH(exact, x);
  const Lanes shifted = x * 0.63661977236758134308 + round, n = shifted - round;
  const Lanes r = x - n * 1.57079625129699707031 - n * 7.54978941586159635336e-8 - n * 5.39030285815811905290e-15;
  const Lanes rr = r * r;
  const Lanes sine = r + r * rr * (((((1.58962301576546568060e-10 * rr - 2.50507477628578072866e-8) * rr +
                                      2.75573136213857245213e-6) * rr - 1.98412698295895385996e-4) * rr +
                                    8.33333333332211858878e-3) * rr - 1.66666666666666307295e-1);
  const Lanes cosine = 1.0 - 0.5 * rr + rr * rr * (((((2.08757008419747316778e-9 - 1.13585365213876817300e-11 * rr) * rr -
                                                      2.75573141792967388112e-7) * rr + 2.48015872888517045348e-5) * rr -
                                                    1.38888888888730564116e-3) * rr + 4.16666666666665929218e-2);
  const Bits turn = (Bits)shifted - (Bits)round + quarter;
  const Lanes size = where((turn & 1) != 0, cosine, sine);
  return where((turn & 2) != 0, -size, size);
}

#endif

#define SMALLER(a, b) WHERE(((a) <= (b)) | ((b) != (b)), a, b)
#define LARGER(a, b) WHERE(((a) >= (b)) | ((b) != (b)), a, b)
#define SIGN(a) (TRUTH((a) > 0.0) - TRUTH((a) < 0.0) + 0.0 * (a))

/* Sensitivities: those of several horizons in one column, or of one horizon in COLUMNS columns. */
#if LANES == 1
#define BESIDE COLUMNS
typedef double Slope __attribute__((vector_size(8 * COLUMNS)));
#define SPREAD(a) ((Slope){0.0} + (a))
#define COUNTED(weight, a) ((weight) != 0.0 ? (a) : SPREAD(0.0))
#define COLUMN(a, j) SPREAD(AT((a)[(j) / BESIDE], (j) % BESIDE))
#else
#define BESIDE 1
typedef Lanes Slope;
#define SPREAD(a) (a)
#define COUNTED(weight, a) WHERE((weight) != 0.0, a, FILL(0.0))
#define COLUMN(a, j) ((a)[j])
#endif
/* Column j of row r, of a matrix of so many rows. */
#define SLOPE(a, rows, r, j, lane) AT((a)[(j) / BESIDE * (rows) + (r)], BESIDE == 1 ? (lane) : (j) % BESIDE)

/* Where a part of a model is to be computed for one group: states, their sensitivities, inputs and time; and where its
   value and the value's sensitivities go. Matrices lie column by column. */
typedef struct {
  const Lanes *x, *u;
  const Slope *s;
  Lanes t, *value;
  Slope *slope;
} Place;

/* A step of a model, or its outputs, at `groups` places, with the first `columns` of the sensitivities. One stage of a
   step waits for the one before; so the stages of the groups take turns. `prepare` computes what depends on the
   parameters and on the step h alone, `constants` numbers of it. */
typedef struct {
  long long constants;
  void (*prepare)(double h, const double *p, double *c);
  void (*run)(const Place *at, int groups, double h, const double *p, const double *c, long long columns);
} Part;
