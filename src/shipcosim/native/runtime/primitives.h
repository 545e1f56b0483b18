/* Numeric primitives that models ask for: what NumPy does for them in Python. Each takes its result, and its arguments
   with their number. Matrices lie row by row. */

/* Product of A (l, m) and B (m, n): a holds l, m, n, A, B. */
static void multiplied(double *result, const double *a, int count)
{
    int l = (int)a[0], m = (int)a[1], n = (int)a[2];
    const double *A = a + 3, *B = A + l * m;

    (void)count;
    for (int i = 0; i < l; i++)
        for (int j = 0; j < n; j++) {
            double sum = 0.0;

            for (int k = 0; k < m; k++)
                sum += A[i * m + k] * B[k * n + j];
            result[i * n + j] = sum;
        }
}

/* Solution of A x = b for m right sides, by elimination with row exchange: a holds n, m, A (n, n), b (n, m). */
static void solved(double *x, const double *a, int count)
{
    int n = (int)a[0], m = (int)a[1];
    double *A = malloc((size_t)(n * n) * sizeof *A);

    (void)count;
    if (!A) {
        for (int i = 0; i < n * m; i++)
            x[i] = NAN;
        return;
    }
    memcpy(A, a + 2, (size_t)(n * n) * sizeof *A);
    memcpy(x, a + 2 + n * n, (size_t)(n * m) * sizeof *x);
    for (int k = 0; k < n; k++) {
        int pivot = k;

        for (int i = k + 1; i < n; i++)
            if (fabs(A[i * n + k]) > fabs(A[pivot * n + k]))
                pivot = i;
        for (int j = 0; pivot != k && j < n; j++) {
            double kept = A[k * n + j];

            A[k * n + j] = A[pivot * n + j];
            A[pivot * n + j] = kept;
        }
        for (int j = 0; pivot != k && j < m; j++) {
            double kept = x[k * m + j];

            x[k * m + j] = x[pivot * m + j];
            x[pivot * m + j] = kept;
        }
        for (int i = k + 1; i < n; i++) {
            double factor = A[i * n + k] / A[k * n + k];

            for (int j = k + 1; j < n; j++)
                A[i * n + j] -= factor * A[k * n + j];
            for (int j = 0; j < m; j++)
                x[i * m + j] -= factor * x[k * m + j];
        }
    }
    for (int j = 0; j < m; j++)
        for (int i = n - 1; i >= 0; i--) {
            double sum = x[i * m + j];

            for (int k = i + 1; k < n; k++)
                sum -= A[i * n + k] * x[k * m + j];
            x[i * m + j] = sum / A[i * n + i];
        }
    free(A);
}

/* Generalised inverse (n, m) of A (m, n), without singular values below a share of the largest: a holds m, n, the
   share, A. One-sided rotations of Jacobi: Golub and Van Loan, Matrix Computations, 4th ed., section 8.6.3. */
static void pseudo_inverse(double *result, const double *a, int count)
{
    int m = (int)a[0], n = (int)a[1], turned = m < n, rows = turned ? n : m, columns = turned ? m : n;
    double share = a[2], largest = 0.0, *U = malloc((size_t)(rows * columns + columns * columns + 1) * sizeof *U);
    double *V = U + rows * columns;

    (void)count;
    for (int i = 0; i < m * n; i++)
        result[i] = U ? 0.0 : NAN;
    if (!U)
        return;
    for (int i = 0; i < rows; i++)
        for (int j = 0; j < columns; j++)
            U[i * columns + j] = turned ? a[3 + j * n + i] : a[3 + i * n + j];
    for (int i = 0; i < columns * columns; i++)
        V[i] = i % (columns + 1) == 0;
    for (int sweep = 0, rotated = 1; rotated && sweep < 60; sweep++) {
        rotated = 0;
        for (int p = 0; p < columns; p++)
            for (int q = p + 1; q < columns; q++) {
                double alpha = 0.0, beta = 0.0, gamma = 0.0, zeta, t, c, s;

                for (int i = 0; i < rows; i++) {
                    alpha += U[i * columns + p] * U[i * columns + p];
                    beta += U[i * columns + q] * U[i * columns + q];
                    gamma += U[i * columns + p] * U[i * columns + q];
                }
                if (gamma == 0.0 || fabs(gamma) <= 1e-16 * sqrt(alpha * beta))
                    continue;
                rotated = 1;
                zeta = (beta - alpha) / (2.0 * gamma);
                t = copysign(1.0, zeta) / (fabs(zeta) + sqrt(1.0 + zeta * zeta));
                c = 1.0 / sqrt(1.0 + t * t);
                s = c * t;
                for (int i = 0; i < rows + columns; i++) {
                    double *row = i < rows ? U + i * columns : V + (i - rows) * columns;
                    double kept = row[p];

                    row[p] = c * kept - s * row[q];
                    row[q] = s * kept + c * row[q];
                }
            }
    }
    for (int j = 0; j < columns; j++) {
        double size = 0.0;

        for (int i = 0; i < rows; i++)
            size += U[i * columns + j] * U[i * columns + j];
        largest = fmax(largest, sqrt(size));
    }
    for (int j = 0; j < columns; j++) {
        double square = 0.0;

        for (int i = 0; i < rows; i++)
            square += U[i * columns + j] * U[i * columns + j];
        if (!(sqrt(square) > share * largest))
            continue;
        for (int k = 0; k < columns; k++)
            for (int i = 0; i < rows; i++) {
                double part = V[k * columns + j] * U[i * columns + j] / square;

                result[turned ? i * columns + k : k * rows + i] += part;
            }
    }
    free(U);
}

/* Linear interpolation of m values in a table of n that grows, as numpy.interp: a holds m, n, x, the table's columns. */
static void interpolated_in(double *result, const double *a, int count)
{
    int m = (int)a[0], n = (int)a[1];
    const double *x = a + 2, *xs = x + m, *ys = xs + n;

    (void)count;
    for (int k = 0; k < m; k++) {
        int low = 0, high = n - 1;

        if (x[k] <= xs[0] || x[k] >= xs[n - 1]) {
            result[k] = x[k] <= xs[0] ? ys[0] : ys[n - 1];
            continue;
        }
        while (high - low > 1) {
            int middle = (low + high) / 2;

            if (x[k] < xs[middle])
                high = middle;
            else
                low = middle;
        }
        result[k] = x[k] == xs[low] ? ys[low] : (ys[low + 1] - ys[low]) / (xs[low + 1] - xs[low]) * (x[k] - xs[low]) + ys[low];
    }
}
