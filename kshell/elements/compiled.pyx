# cython: language_level=3, boundscheck=False, wraparound=False, cdivision=True, initializedcheck=False
"""The loop of kshell.elements.hierarchic, compiled. It makes what numpy makes there, number by number."""


VERSION = 1  # as in kshell.elements.kernels
LARGEST_DEGREE = 31
cdef enum:
    MOST = 32


def orthonormal(const double[::1] x0, const double[::1] x1, const double[:, ::1] slope, const double[:, ::1] shift,
                const double[:, ::1] back, const double[::1] norm, double[:, ::1] out):
    """Values (point, k) of psi at points of coordinates x0 and x1.

    Parameters
    ----------
    slope, shift, back : (n, i), of the recurrences of `kshell.elements.jets.jacobi_family`, n up to the degree
    norm : (k,)
    """
    cdef Py_ssize_t points = x0.shape[0], degree = slope.shape[0] - 1
    cdef Py_ssize_t p, n, i, total, k
    cdef double x, y, square, value
    cdef double[MOST] along
    cdef double[MOST][MOST] across
    if degree >= MOST:
        raise ValueError("the degree is too high")
    with nogil:
        for p in range(points):
            x = 2.0 * x0[p] + x1[p] - 1.0
            square = (1.0 - x1[p]) * (1.0 - x1[p])
            y = 2.0 * x1[p] - 1.0
            along[0] = 1.0
            if degree > 0:
                along[1] = x
            for n in range(1, degree):
                along[n + 1] = (((2 * n + 1) / <double>(n + 1)) * x * along[n]
                                - (n / <double>(n + 1)) * square * along[n - 1])
            for i in range(degree + 1):
                across[0][i] = 1.0
            for n in range(1, degree + 1):
                for i in range(degree + 1 - n):
                    value = (slope[n, i] * y + shift[n, i]) * across[n - 1][i]
                    if n > 1:
                        value = value - back[n, i] * across[n - 2][i]
                    across[n][i] = value
            k = 0
            for total in range(degree + 1):
                for i in range(total, -1, -1):
                    out[p, k] = along[i] * across[total - i][i] * norm[k]
                    k += 1
