/* Kalman filter and smoother over the rows of a log; __init__.py says what goes in and out.

Arrays are of doubles, row by row and without gaps; their axes are in the order in which __init__.py gives them. An array
with one log in place of m serves all. Sums run in the order of the text, without fused operations: results are the
same on every machine. */

#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#ifdef _WIN32
#define EXPORT __declspec(dllexport)
#else
#define EXPORT __attribute__((visibility("default")))
#endif

/* What the library was compiled from, see compile.py. */
EXPORT const char sources[] = SOURCES;

typedef double *restrict out;
typedef const double *restrict in;
typedef int64_t size;

/* Adds sign M X to the first r rows of Y: M has r rows and k columns of `stride`, X and Y have c columns. Most entries
of M are 0, and cost nothing. */
static void add(out Y, in M, size r, size k, size stride, in X, size c, double sign)
{
    for (size i = 0; i < r; i++)
        for (size j = 0; j < k; j++) {
            double factor = sign * M[i * stride + j];
            if (factor != 0.0)
                for (size column = 0; column < c; column++)
                    Y[i * c + column] += factor * X[j * c + column];
        }
}

/* Adds M' X to Y: M has k rows and r columns, X k rows of c columns. */
static void add_transposed(out Y, in M, size k, size r, in X, size c)
{
    for (size j = 0; j < k; j++)
        for (size i = 0; i < r; i++) {
            double factor = M[j * r + i];
            for (size column = 0; column < c; column++)
                Y[i * c + column] += factor * X[j * c + column];
        }
}

/* Sets an s x s matrix to the mean of T and its transpose. */
static void set_symmetric(out V, in T, size s)
{
    for (size i = 0; i < s; i++)
        for (size j = 0; j <= i; j++)
            V[i * s + j] = V[j * s + i] = 0.5 * (T[i * s + j] + T[j * s + i]);
}

/* Lower half of the o x o covariance of outputs h C h', by the o x s product h C. */
static void seen_covariance(out S, in h, in hC, size o, size s)
{
    for (size i = 0; i < o; i++) {
        for (size j = 0; j <= i; j++)
            S[i * o + j] = 0.0;
        for (size k = 0; k < s; k++)
            if (h[i * s + k] != 0.0)
                for (size j = 0; j <= i; j++)
                    S[i * o + j] += h[i * s + k] * hC[j * s + k];
    }
}

/* Logarithm of the determinant of S + diag(R), of what is measured; `inverse` becomes the inverse of its lower Cholesky
factor, in whose place L is worked out. */
static double inverse_root(in S, in R, out L, out inverse, size o)
{
    double determinant = 1.0;
    for (size i = 0; i < o; i++) {
        for (size j = 0; j <= i; j++) {
            double rest = S[i * o + j] + (i == j ? R[i] : 0.0);
            for (size k = 0; k < j; k++)
                rest -= L[i * o + k] * L[j * o + k];
            L[i * o + j] = i == j ? sqrt(rest) : rest / L[j * o + j];
        }
        if (isfinite(R[i]))
            determinant *= L[i * o + i];
        inverse[i * o + i] = 1.0 / L[i * o + i];
        for (size j = 0; j < i; j++) {
            double rest = 0.0;
            for (size k = j; k < i; k++)
                rest -= L[i * o + k] * inverse[k * o + j];
            inverse[i * o + j] = rest / L[i * o + i];
        }
    }
    return 2.0 * log(determinant);
}

/* Takes from an s x s covariance what o outputs with these gains tell. */
static void take_out(out V, in gain, size o, size s)
{
    for (size k = 0; k < o; k++)
        for (size i = 0; i < s; i++) {
            double factor = gain[k * s + i];
            for (size j = 0; j < s; j++)
                V[i * s + j] -= factor * gain[k * s + j];
        }
}

/* Covariance V of the next row: (A + W) V (A + W)' + Q, and `lost` where what drives the ship is not known. T and U are
room for s x s. */
static void step_covariance(out V, in A, size a, in W, in Q, const double *lost, size s, out T, out U)
{
    memset(T, 0, s * s * sizeof *T);
    add(T, A, a, a, a, V, s, 1.0);
    add(T, W, s, s, s, V, s, 1.0);
    for (size i = 0; i < s; i++)
        for (size j = 0; j < s; j++)
            U[j * s + i] = T[i * s + j];
    memcpy(T, Q, s * s * sizeof *T);
    for (size i = 0; lost && i < s; i++)
        T[i * s + i] += lost[i * s + i];
    add(T, A, a, a, a, U, s, 1.0);
    add(T, W, s, s, s, U, s, 1.0);
    set_symmetric(V, T, s);
}

/* Returns 0, or 1 where there is no memory; so do all that follow. */
EXPORT int weights(size n, size m, size o, size s, size a, size steps, size logs_A, size logs_H, in A, in W, in H, in R,
                   in Q, out C, const uint8_t *known, in lost, const uint8_t *is_last, in begun, out gain, out root,
                   out logdet, double *covariances)
{
    double *room = malloc((o * s + 2 * o * o + 2 * s * s) * sizeof *room);
    if (!room)
        return 1;
    double *hC = room, *S = hC + o * s, *L = S + o * o, *T = L + o * o, *U = T + s * s;
    memset(gain, 0, n * m * o * s * sizeof *gain);
    memset(root, 0, n * m * o * o * sizeof *root);
    memset(L, 0, o * o * sizeof *L);
    for (size log = 0; log < m; log++) {
        double *V = C + log * s * s;
        for (size k = 0; k < n; k++) {
            size here = k * m + log;
            const double *h = H + (k * logs_H + log % logs_H) * o * s;
            memset(hC, 0, o * s * sizeof *hC);
            add(hC, h, o, s, s, V, s, 1.0);
            seen_covariance(S, h, hC, o, s);
            logdet[here] = inverse_root(S, R + here * o, L, root + here * o * o, o);
            add(gain + here * o * s, root + here * o * o, o, o, o, hC, s, 1.0);
            take_out(V, gain + here * o * s, o, s);
            if (covariances)
                memcpy(covariances + here * s * s, V, s * s * sizeof *V);
            if (k < steps) {
                const double *step = A + (k * logs_A + log % logs_A) * a * a;
                step_covariance(V, step, a, W + log * s * s, Q + log * s * s, known[k] ? NULL : lost, s, T, U);
                if (is_last[k])
                    memcpy(V, begun + log * s * s, s * s * sizeof *V);
            }
        }
    }
    free(room);
    return 0;
}

EXPORT int whitened(size n, size m, size o, size s, size a, size b, size c, size steps, size logs_A, size logs_B,
                    size logs_H, size logs_Z, in A, in W, in B, in H, in Z, in gain, in root, const uint8_t *is_last,
                    out x, out white, out states)
{
    double *room = malloc((o * c + s * c) * sizeof *room);
    if (!room)
        return 1;
    double *missed = room, *ahead = room + o * c;
    memset(white, 0, n * m * o * c * sizeof *white);
    for (size log = 0; log < m; log++) {
        double *y = x + log * s * c;
        for (size k = 0; k < n; k++) {
            size here = k * m + log;
            memcpy(missed, Z + (k * logs_Z + log % logs_Z) * o * c, o * c * sizeof *missed);
            add(missed, H + (k * logs_H + log % logs_H) * o * s, o, s, s, y, c, -1.0);
            add(white + here * o * c, root + here * o * o, o, o, o, missed, c, 1.0);
            add_transposed(y, gain + here * o * s, o, s, white + here * o * c, c);
            for (size i = 0; i < s; i++)
                states[here * s + i] = y[i * c];
            if (k < steps) {
                memset(ahead, 0, s * c * sizeof *ahead);
                memcpy(ahead, B + (k * logs_B + log % logs_B) * b * c, b * c * sizeof *ahead);
                add(ahead, A + (k * logs_A + log % logs_A) * a * a, a, a, a, y, c, 1.0);
                add(ahead, W + log * s * s, s, s, s, y, c, 1.0);
                memcpy(y, ahead, s * c * sizeof *y);
                if (is_last[k])
                    memset(y, 0, s * c * sizeof *y);
            }
        }
    }
    free(room);
    return 0;
}

/* Adds M' v, with r x c M, to `found`. */
static void add_product(out found, in M, size r, size c, in v)
{
    for (size i = 0; i < r; i++)
        for (size j = 0; j < c; j++)
            found[j] += v[i] * M[i * c + j];
}

/* Sets `found` to `start` plus sign M v, with r x c M. */
static void set_product(out found, in start, in M, size r, size c, in v, double sign)
{
    for (size i = 0; i < r; i++) {
        double total = 0.0;
        for (size j = 0; j < c; j++)
            total += M[i * c + j] * v[j];
        found[i] = start[i] + sign * total;
    }
}

EXPORT int smoothed(size n, size m, size o, size s, size a, size steps, size logs_A, size logs_H, in A, in W, in H,
                    in white, in gain, in root, in states, in covariances, const uint8_t *is_last, out pull, out found)
{
    double *room = malloc((s + o) * sizeof *room);
    if (!room)
        return 1;
    double *moved = room, *left = room + s;
    for (size log = 0; log < m; log++) {
        double *p = pull + log * s;
        for (size k = n - 1; k >= 0; k--) {
            size here = k * m + log;
            if (k < steps) {
                memset(moved, 0, s * sizeof *moved);
                add_product(moved, A + (k * logs_A + log % logs_A) * a * a, a, a, p);
                add_product(moved, W + log * s * s, s, s, p);
                for (size i = 0; i < s; i++)
                    p[i] = is_last[k] ? 0.0 : moved[i];
            }
            set_product(found + here * s, states + here * s, covariances + here * s * s, s, s, p, 1.0);
            set_product(left, white + here * o, gain + here * o * s, o, s, p, -1.0);
            const double *h = H + (k * logs_H + log % logs_H) * o * s, *r = root + here * o * o;
            for (size i = 0; i < o; i++) {
                double share = 0.0;
                for (size j = i; j < o; j++)
                    share += r[j * o + i] * left[j];
                for (size j = 0; j < s; j++)
                    p[j] += h[i * s + j] * share;
            }
        }
    }
    free(room);
    return 0;
}

/* Adds W X to Y, with W of each of m logs (s, s, m), and X and Y (s, c) with the logs side by side in each column. */
static void add_each(out Y, in W, in X, size s, size c, size m)
{
    for (size i = 0; i < s; i++)
        for (size j = 0; j < s; j++)
            if (W[(i * s + j) * m] != 0.0)
                for (size first = 0; first < c; first += m)
                    for (size log = 0; log < m; log++)
                        Y[i * c + first + log] += W[(i * s + j) * m + log] * X[j * c + first + log];
}

/* Takes in one output z = h x of m noises: state x (s, m), covariance C (s, s, m) and log-likelihoods after it. `seen`
is room for s m, `missed`, `S` and `share` for m. */
static void take_in(out x, out C, in h, double z, in R, out found, size s, size m, out seen, out missed, out S, out share)
{
    memset(seen, 0, s * m * sizeof *seen);
    for (size log = 0; log < m; log++) {
        missed[log] = z;
        S[log] = R[log];
    }
    for (size j = 0; j < s; j++)
        if (h[j] != 0.0) {
            for (size log = 0; log < m; log++)
                missed[log] -= h[j] * x[j * m + log];
            for (size place = 0; place < s * m; place++)
                seen[place] += h[j] * C[j * s * m + place];
        }
    for (size j = 0; j < s; j++)
        if (h[j] != 0.0)
            for (size log = 0; log < m; log++)
                S[log] += h[j] * seen[j * m + log];
    for (size n = 0; n < m; n++) {
        found[n] -= 0.5 * (missed[n] * missed[n] / S[n] + log(S[n]));
        S[n] = 1.0 / S[n];
    }
    for (size i = 0; i < s; i++) {
        for (size log = 0; log < m; log++) {
            share[log] = seen[i * m + log] * S[log];
            x[i * m + log] += share[log] * missed[log];
        }
        for (size j = 0; j < s; j++)
            for (size log = 0; log < m; log++)
                C[(i * s + j) * m + log] -= share[log] * seen[j * m + log];
    }
}

EXPORT int log_likelihoods(size n, size m, size o, size s, size a, size r, in A, in W, in b, in H, in z,
                           const uint8_t *whole, in R, in Q, in P, const uint8_t *known, in lost,
                           const uint8_t *is_last, out found)
{
    size all = s * s * m;
    double *room = calloc(2 * all + 3 * s * m + 3 * m, sizeof *room);
    if (!room)
        return 1;
    double *C = room, *T = C + all, *x = T + all, *ahead = x + s * m, *seen = ahead + s * m;
    double *missed = seen + s * m, *S = missed + m, *share = S + m;
    memcpy(C, P, all * sizeof *C);
    memset(found, 0, m * sizeof *found);
    for (size k = 0; k < n; k++) {
        for (size i = 0; i < o; i++)
            if (whole[k * o + i])
                take_in(x, C, H + (k * o + i) * s, z[k * o + i], R + i * m, found, s, m, seen, missed, S, share);
        if (k == n - 1)
            break;
        memset(ahead, 0, s * m * sizeof *ahead);
        for (size i = 0; i < r; i++)
            for (size log = 0; log < m; log++)
                ahead[i * m + log] = b[k * r + i];
        add(ahead, A + k * a * a, a, a, a, x, m, 1.0);
        add_each(ahead, W, x, s, m, m);
        memcpy(x, ahead, s * m * sizeof *x);
        memset(T, 0, all * sizeof *T);
        add(T, A + k * a * a, a, a, a, C, s * m, 1.0);
        add_each(T, W, C, s, s * m, m);
        for (size i = 0; i < s; i++)
            for (size j = 0; j < s; j++)
                memcpy(C + (j * s + i) * m, T + (i * s + j) * m, m * sizeof *C);
        memcpy(T, Q, all * sizeof *T);
        for (size i = 0; !known[k] && i < s; i++)
            for (size log = 0; log < m; log++)
                T[(i * s + i) * m + log] += lost[i * s + i];
        add(T, A + k * a * a, a, a, a, C, s * m, 1.0);
        add_each(T, W, C, s, s * m, m);
        /* symmetric, else what rounding makes of it grows over a long log */
        for (size i = 0; i < s; i++)
            for (size j = 0; j <= i; j++)
                for (size log = 0; log < m; log++) {
                    double mean = 0.5 * (T[(i * s + j) * m + log] + T[(j * s + i) * m + log]);
                    C[(i * s + j) * m + log] = C[(j * s + i) * m + log] = mean;
                }
        if (is_last[k]) {
            memset(x, 0, s * m * sizeof *x);
            memcpy(C, P, all * sizeof *C);
        }
    }
    free(room);
    return 0;
}
