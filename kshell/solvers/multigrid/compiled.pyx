# cython: language_level=3, boundscheck=False, wraparound=False, cdivision=True, initializedcheck=False
"""The loops of multigrid, compiled: products P^T A P, sweeps that leave the residual behind, and interpolation.

Blocks are (h, h) of a matrix A and (h, 3) of a prolongation P; h is 1 on the element, 3 on vertices. A is symmetric, its
rows are sorted, and every one of them has its diagonal.
"""

import numpy as np

from libc.stdint cimport int32_t, int64_t, uint32_t
from libc.stdlib cimport free, malloc, realloc
from libc.string cimport memset


VERSION = 3  # as in kshell.solvers.kernels


cdef struct Table:
    # columns of each row by hashing: where its places begin, how many there are (a power of two) and are filled
    int64_t* first
    int32_t* size
    int32_t* filled
    # of each place: the column, -1 where there is none, and the number of its block
    int32_t* keys
    int32_t* numbers
    int64_t used, room
    double* blocks
    int64_t count, blocks_room


cdef enum:
    START = 32  # places of a row at first


cdef int _open(Table* t, Py_ssize_t rows) noexcept nogil:
    """Room for a table; whether there was enough memory."""
    cdef Py_ssize_t i
    t.used = t.room = START * <int64_t>rows
    t.count, t.blocks_room = 0, 8 * <int64_t>rows + 8
    t.first = <int64_t*>malloc(rows * sizeof(int64_t) + 1)
    t.size = <int32_t*>malloc(rows * sizeof(int32_t) + 1)
    t.filled = <int32_t*>malloc(rows * sizeof(int32_t) + 1)
    t.keys = <int32_t*>malloc(t.room * sizeof(int32_t) + 1)
    t.numbers = <int32_t*>malloc(t.room * sizeof(int32_t) + 1)
    t.blocks = <double*>malloc(9 * t.blocks_room * sizeof(double))
    if not (t.first and t.size and t.filled and t.keys and t.numbers and t.blocks):
        return 0
    memset(t.keys, 0xFF, t.room * sizeof(int32_t))
    for i in range(rows):
        t.first[i], t.size[i], t.filled[i] = START * <int64_t>i, START, 0
    return 1


cdef void _close(Table* t) noexcept nogil:
    free(t.first)
    free(t.size)
    free(t.filled)
    free(t.keys)
    free(t.numbers)
    free(t.blocks)


cdef inline int64_t _place(const int32_t* keys, int32_t mask, int32_t key) noexcept nogil:
    """The place of a column among those of its row, or the free one for it."""
    cdef int32_t at = <int32_t>((<uint32_t>key * <uint32_t>2654435761) >> 12) & mask
    while keys[at] != key and keys[at] != -1:
        at = (at + 1) & mask
    return at


cdef int _grown(Table* t, Py_ssize_t row) noexcept nogil:
    """Twice as many places for a row; whether there was enough memory."""
    cdef int32_t size = t.size[row], i
    cdef int64_t old = t.first[row], at, room
    cdef void* more
    if t.used + 2 * size > t.room:
        room = t.room + t.room // 2 + 2 * size
        more = realloc(t.keys, room * sizeof(int32_t))
        if not more:
            return 0
        t.keys = <int32_t*>more
        more = realloc(t.numbers, room * sizeof(int32_t))
        if not more:
            return 0
        t.numbers = <int32_t*>more
        t.room = room
    t.first[row], t.size[row] = t.used, 2 * size
    memset(t.keys + t.used, 0xFF, 2 * size * sizeof(int32_t))
    for i in range(size):
        if t.keys[old + i] >= 0:
            at = t.used + _place(t.keys + t.used, 2 * size - 1, t.keys[old + i])
            t.keys[at], t.numbers[at] = t.keys[old + i], t.numbers[old + i]
    t.used += 2 * size
    return 1


cdef inline int64_t _number(Table* t, Py_ssize_t row, int32_t key) noexcept nogil:
    """The number of a block, a new one of zeros if need be; -1 if memory is short."""
    cdef int64_t at = t.first[row] + _place(t.keys + t.first[row], t.size[row] - 1, key)
    if t.keys[at] == key:
        return t.numbers[at]
    return _new(t, row, key, at)


cdef int64_t _new(Table* t, Py_ssize_t row, int32_t key, int64_t at) noexcept nogil:
    cdef void* more
    cdef int64_t room
    if 4 * (t.filled[row] + 1) > 3 * t.size[row]:
        if not _grown(t, row):
            return -1
        at = t.first[row] + _place(t.keys + t.first[row], t.size[row] - 1, key)
    if t.count == t.blocks_room:
        room = t.blocks_room + t.blocks_room // 2
        more = realloc(t.blocks, 9 * room * sizeof(double))
        if not more:
            return -1
        t.blocks, t.blocks_room = <double*>more, room
    t.keys[at], t.numbers[at] = key, <int32_t>t.count
    memset(t.blocks + 9 * t.count, 0, 9 * sizeof(double))
    t.filled[row] += 1
    t.count += 1
    return t.count - 1


def product(const int32_t[::1] indptr, const int32_t[::1] indices, const double[:, :, ::1] data,
            const int32_t[::1] p_indptr, const int32_t[::1] p_indices, const double[:, :, ::1] p_data, Py_ssize_t coarse):
    """P^T A P as indptr, indices and (block, 3, 3) data of sorted rows; every row has its diagonal."""
    cdef Py_ssize_t n = indptr.shape[0] - 1, h = data.shape[1], i, k, p, q, a, b, c, s, many, at
    cdef int32_t row, column
    cdef int64_t number = 0
    cdef double x, y, z
    cdef const double* left
    cdef double* w
    cdef double* to
    cdef Table t
    seen_array, slot_array = np.full(coarse, -1, dtype=np.int32), np.empty(coarse, dtype=np.int32)
    near_array, sums_array = np.empty(coarse, dtype=np.int32), np.empty((coarse, h, 3))
    cdef int32_t[::1] seen = seen_array, slot = slot_array, near = near_array
    cdef double[:, :, ::1] sums = sums_array  # A P in the row of A, for the columns that are near
    cdef bint enough = _open(&t, coarse)
    if enough:
        with nogil:
            for i in range(coarse):
                number = _number(&t, i, <int32_t>i)
                if number < 0:
                    break
            for i in range(n):
                if number < 0:
                    break
                many = 0
                for p in range(indptr[i], indptr[i + 1]):
                    k = indices[p]
                    for q in range(p_indptr[k], p_indptr[k + 1]):
                        column = p_indices[q]
                        if seen[column] != i:
                            seen[column], slot[column] = <int32_t>i, <int32_t>many
                            near[many] = column
                            memset(&sums[many, 0, 0], 0, 3 * h * sizeof(double))
                            many += 1
                        w = &sums[slot[column], 0, 0]
                        left = &p_data[q, 0, 0]
                        if h == 1:
                            x = data[p, 0, 0]
                            w[0] += x * left[0]
                            w[1] += x * left[1]
                            w[2] += x * left[2]
                        else:
                            for a in range(3):
                                x, y, z = data[p, a, 0], data[p, a, 1], data[p, a, 2]
                                for b in range(3):
                                    w[3 * a + b] += x * left[b] + y * left[3 + b] + z * left[6 + b]
                for q in range(p_indptr[i], p_indptr[i + 1]):
                    row = p_indices[q]
                    left = &p_data[q, 0, 0]
                    for s in range(many):
                        if near[s] < row:
                            continue
                        number = _number(&t, row, near[s])
                        if number < 0:
                            break
                        to = t.blocks + 9 * number
                        w = &sums[s, 0, 0]
                        for c in range(h):
                            for a in range(3):
                                x = left[3 * c + a]
                                to[3 * a] += x * w[3 * c]
                                to[3 * a + 1] += x * w[3 * c + 1]
                                to[3 * a + 2] += x * w[3 * c + 2]
    if not enough or number < 0:
        _close(&t)
        raise MemoryError("no memory for the coarse matrices of multigrid")
    pointer_array = np.zeros(coarse + 1, dtype=np.int64)
    cdef int64_t[::1] pointer = pointer_array
    with nogil:
        for i in range(coarse):
            for at in range(t.first[i], t.first[i] + t.size[i]):
                if t.keys[at] >= 0:
                    pointer[i + 1] += 1
                    if t.keys[at] != i:
                        pointer[t.keys[at] + 1] += 1
        for i in range(coarse):
            pointer[i + 1] += pointer[i]
    total = int(pointer_array[coarse])
    columns_array, blocks_array = np.empty(total, dtype=np.int32), np.empty((total, 3, 3))
    end_array = pointer_array[:coarse].copy()
    cdef int32_t[::1] columns = columns_array
    cdef double[:, :, ::1] blocks = blocks_array
    cdef int64_t[::1] end = end_array
    with nogil:
        for i in range(coarse):
            many = 0  # columns of the row not before its own, sorted
            for at in range(t.first[i], t.first[i] + t.size[i]):
                column = t.keys[at]
                if column >= 0:
                    p = many
                    while p > 0 and near[p - 1] > column:
                        near[p], slot[p] = near[p - 1], slot[p - 1]
                        p -= 1
                    near[p], slot[p] = column, t.numbers[at]
                    many += 1
            for s in range(many):
                to = t.blocks + 9 * <int64_t>slot[s]
                column = near[s]
                at = end[i]
                columns[at] = column
                for a in range(9):
                    (&blocks[at, 0, 0])[a] = to[a]
                end[i] += 1
                if column != i:
                    at = end[column]
                    columns[at] = <int32_t>i
                    for a in range(3):
                        for b in range(3):
                            blocks[at, a, b] = to[3 * b + a]
                    end[column] += 1
    _close(&t)
    return pointer_array.astype(np.int32), columns_array, blocks_array


def forward(const int32_t[::1] indptr, const int32_t[::1] indices, const double[:, :, ::1] data, double[::1] r,
            double[::1] e):
    """One sweep of Gauss-Seidel for A e = r from e = 0; r becomes r - A e. Of A only what is below the diagonal."""
    cdef Py_ssize_t n = indptr.shape[0] - 1, i, j, p
    cdef double s, x, y, z, u, v, w
    cdef const double* a
    with nogil:
        if data.shape[1] == 1:
            for i in range(n):
                s = r[i]
                p = indptr[i]
                while indices[p] < i:
                    s -= data[p, 0, 0] * e[indices[p]]
                    p += 1
                s /= data[p, 0, 0]
                e[i], r[i] = s, 0.0
                for p in range(indptr[i], p):
                    r[indices[p]] -= data[p, 0, 0] * s
        else:
            for i in range(n):
                x, y, z = r[3 * i], r[3 * i + 1], r[3 * i + 2]
                p = indptr[i]
                while indices[p] < i:
                    j = 3 * <Py_ssize_t>indices[p]
                    a = &data[p, 0, 0]
                    u, v, w = e[j], e[j + 1], e[j + 2]
                    x -= a[0] * u + a[1] * v + a[2] * w
                    y -= a[3] * u + a[4] * v + a[5] * w
                    z -= a[6] * u + a[7] * v + a[8] * w
                    p += 1
                a = &data[p, 0, 0]
                x /= a[0]
                y = (y - a[3] * x) / a[4]
                z = (z - a[6] * x - a[7] * y) / a[8]
                e[3 * i], e[3 * i + 1], e[3 * i + 2] = x, y, z
                r[3 * i], r[3 * i + 1], r[3 * i + 2] = -a[1] * y - a[2] * z, -a[5] * z, 0.0
                for p in range(indptr[i], p):
                    j = 3 * <Py_ssize_t>indices[p]
                    a = &data[p, 0, 0]
                    r[j] -= a[0] * x + a[3] * y + a[6] * z
                    r[j + 1] -= a[1] * x + a[4] * y + a[7] * z
                    r[j + 2] -= a[2] * x + a[5] * y + a[8] * z


def backward(const int32_t[::1] indptr, const int32_t[::1] indices, const double[:, :, ::1] data, double[::1] r,
             double[::1] e):
    """The same from the last unknown to the first: of A only what is above the diagonal."""
    cdef Py_ssize_t n = indptr.shape[0] - 1, i, j, p
    cdef double s, x, y, z, u, v, w
    cdef const double* a
    with nogil:
        if data.shape[1] == 1:
            for i in range(n - 1, -1, -1):
                s = r[i]
                p = indptr[i + 1] - 1
                while indices[p] > i:
                    s -= data[p, 0, 0] * e[indices[p]]
                    p -= 1
                s /= data[p, 0, 0]
                e[i], r[i] = s, 0.0
                for p in range(p + 1, indptr[i + 1]):
                    r[indices[p]] -= data[p, 0, 0] * s
        else:
            for i in range(n - 1, -1, -1):
                x, y, z = r[3 * i], r[3 * i + 1], r[3 * i + 2]
                p = indptr[i + 1] - 1
                while indices[p] > i:
                    j = 3 * <Py_ssize_t>indices[p]
                    a = &data[p, 0, 0]
                    u, v, w = e[j], e[j + 1], e[j + 2]
                    x -= a[0] * u + a[1] * v + a[2] * w
                    y -= a[3] * u + a[4] * v + a[5] * w
                    z -= a[6] * u + a[7] * v + a[8] * w
                    p -= 1
                a = &data[p, 0, 0]
                z /= a[8]
                y = (y - a[5] * z) / a[4]
                x = (x - a[1] * y - a[2] * z) / a[0]
                e[3 * i], e[3 * i + 1], e[3 * i + 2] = x, y, z
                r[3 * i], r[3 * i + 1], r[3 * i + 2] = 0.0, -a[3] * x, -a[6] * x - a[7] * y
                for p in range(p + 1, indptr[i + 1]):
                    j = 3 * <Py_ssize_t>indices[p]
                    a = &data[p, 0, 0]
                    r[j] -= a[0] * x + a[3] * y + a[6] * z
                    r[j + 1] -= a[1] * x + a[4] * y + a[7] * z
                    r[j + 2] -= a[2] * x + a[5] * y + a[8] * z


def subtract(const int32_t[::1] indptr, const int32_t[::1] indices, const double[:, :, ::1] data, const double[::1] x,
             double[::1] r):
    """r - A x in place of r, for blocks (1, 1), (1, 3) or (3, 3)."""
    cdef Py_ssize_t n = indptr.shape[0] - 1, h = data.shape[1], i, j, p, c
    cdef double s, u, v, w
    with nogil:
        if data.shape[2] == 1:
            for i in range(n):
                s = r[i]
                for p in range(indptr[i], indptr[i + 1]):
                    s -= data[p, 0, 0] * x[indices[p]]
                r[i] = s
        else:
            for i in range(n):
                for p in range(indptr[i], indptr[i + 1]):
                    j = 3 * <Py_ssize_t>indices[p]
                    u, v, w = x[j], x[j + 1], x[j + 2]
                    for c in range(h):
                        r[h * i + c] -= data[p, c, 0] * u + data[p, c, 1] * v + data[p, c, 2] * w


def gather(const int32_t[::1] indptr, const int32_t[::1] indices, const double[:, :, ::1] data, const double[::1] r,
           double[::1] out):
    """Add P^T r, for blocks (1, 3) or (3, 3)."""
    cdef Py_ssize_t n = indptr.shape[0] - 1, h = data.shape[1], i, j, p, c
    cdef double s
    with nogil:
        for i in range(n):
            for p in range(indptr[i], indptr[i + 1]):
                j = 3 * <Py_ssize_t>indices[p]
                for c in range(h):
                    s = r[h * i + c]
                    out[j] += data[p, c, 0] * s
                    out[j + 1] += data[p, c, 1] * s
                    out[j + 2] += data[p, c, 2] * s


def independent(const int32_t[:, ::1] edges, const int64_t[::1] order, const unsigned char[::1] allowed,
                unsigned char[::1] chosen):
    """A maximal independent set among the allowed vertices, taken in an order; `chosen` is zero before."""
    cdef Py_ssize_t n = allowed.shape[0], m = edges.shape[0], k, p
    cdef int32_t a, b
    cdef int64_t v
    starts_array, near_array = np.zeros(n + 2, dtype=np.int64), np.empty(2 * m, dtype=np.int32)
    cdef int64_t[::1] starts = starts_array
    cdef int32_t[::1] near = near_array
    taken_array = np.zeros(n, dtype=np.uint8)
    cdef unsigned char[::1] taken = taken_array  # chosen, or beside what is
    with nogil:
        for k in range(m):
            a, b = edges[k, 0], edges[k, 1]
            if allowed[a] and allowed[b]:
                starts[a + 2] += 1
                starts[b + 2] += 1
        for k in range(n):
            starts[k + 2] += starts[k + 1]
        for k in range(m):
            a, b = edges[k, 0], edges[k, 1]
            if allowed[a] and allowed[b]:
                near[starts[a + 1]], near[starts[b + 1]] = b, a
                starts[a + 1] += 1
                starts[b + 1] += 1
        for k in range(order.shape[0]):
            v = order[k]
            if taken[v]:
                continue
            chosen[v] = taken[v] = 1
            for p in range(starts[v], starts[v + 1]):
                taken[near[p]] = 1


cdef void _bernstein(int i, int j, int k, double factor, const double* power, const double* slope,
                     double* out) noexcept nogil:
    """Weight of an ordinate for value, x and y derivative; powers (3, 4) and gradients (3, 2) of coordinates."""
    cdef double a = power[i], b = power[4 + j], c = power[8 + k], x
    out[0] = factor * (a * b * c)
    out[1] = out[2] = 0.0
    if i:
        x = (factor * i) * (power[i - 1] * b * c)
        out[1] += x * slope[0]
        out[2] += x * slope[1]
    if j:
        x = (factor * j) * (a * power[4 + j - 1] * c)
        out[1] += x * slope[2]
        out[2] += x * slope[3]
    if k:
        x = (factor * k) * (a * b * power[8 + k - 1])
        out[1] += x * slope[4]
        out[2] += x * slope[5]


def clough_tocher(const double[:, ::1] points, const double[:, :, ::1] corners, double[:, :, :, ::1] out):
    """As `kshell.solvers.multigrid.hct.interpolation_weights`, with its symbols."""
    cdef Py_ssize_t p
    cdef int i, j, k, v, d, r, pair, least
    cdef double area, first, second, edge_x, edge_y, b, m, si
    cdef double[3] lam, m2, f_value
    cdef double[6] x, grad, slope  # (vertex, xy), the vertices turned
    cdef double[12] power  # (coordinate, exponent)
    cdef double[9] f, s, t  # (vertex, result)
    cdef double[27] e  # (vertex, vertex, result)
    cdef double[2] centroid
    cdef int[3] order
    with nogil:
        for p in range(points.shape[0]):
            area = ((corners[p, 1, 0] - corners[p, 0, 0]) * (corners[p, 2, 1] - corners[p, 1, 1])
                    - (corners[p, 1, 1] - corners[p, 0, 1]) * (corners[p, 2, 0] - corners[p, 1, 0]))
            for v in range(3):
                i, j = (v + 1) % 3, (v + 2) % 3
                x[2 * v] = -(corners[p, j, 1] - corners[p, i, 1]) / area
                x[2 * v + 1] = (corners[p, j, 0] - corners[p, i, 0]) / area
            edge_x, edge_y = points[p, 0] - corners[p, 0, 0], points[p, 1] - corners[p, 0, 1]
            first = x[2] * edge_x + x[3] * edge_y
            second = x[4] * edge_x + x[5] * edge_y
            f_value[0], f_value[1], f_value[2] = 1.0 - (first + second), first, second
            least = 0
            if f_value[1] < f_value[least]:
                least = 1
            if f_value[2] < f_value[least]:
                least = 2
            for v in range(3):
                order[v] = (least + 1 + v) % 3
                lam[v] = f_value[order[v]]
                grad[2 * v], grad[2 * v + 1] = x[2 * order[v]], x[2 * order[v] + 1]
            for v in range(3):
                x[2 * v], x[2 * v + 1] = corners[p, order[v], 0], corners[p, order[v], 1]
            power[1], power[5], power[9] = lam[0] - lam[2], lam[1] - lam[2], 3.0 * lam[2]
            for v in range(3):
                power[4 * v] = 1.0
                power[4 * v + 2] = power[4 * v + 1] * power[4 * v + 1]
                power[4 * v + 3] = power[4 * v + 2] * power[4 * v + 1]
            for d in range(2):
                slope[d], slope[2 + d], slope[4 + d] = grad[d] - grad[4 + d], grad[2 + d] - grad[4 + d], 3.0 * grad[4 + d]
                centroid[d] = (x[d] + x[2 + d] + x[4 + d]) / 3.0
            memset(f, 0, sizeof(f))
            memset(s, 0, sizeof(s))
            memset(e, 0, sizeof(e))
            _bernstein(0, 0, 3, 1.0, power, slope, t + 6)
            _bernstein(1, 0, 2, 3.0, power, slope, t)
            _bernstein(0, 1, 2, 3.0, power, slope, t + 3)
            _bernstein(3, 0, 0, 1.0, power, slope, f)
            _bernstein(0, 3, 0, 1.0, power, slope, f + 3)
            _bernstein(2, 0, 1, 3.0, power, slope, s)
            _bernstein(0, 2, 1, 3.0, power, slope, s + 3)
            _bernstein(2, 1, 0, 3.0, power, slope, e + 3)
            _bernstein(1, 2, 0, 3.0, power, slope, e + 9)
            _bernstein(1, 1, 1, 6.0, power, slope, m2)
            for r in range(3):
                t[6 + r] /= 3.0
                t[r] += t[6 + r]
                t[3 + r] += t[6 + r]
            for pair in range(3):
                i, j = 0, 1
                if pair == 1:
                    i, j = 1, 2
                elif pair == 2:
                    j = 2
                edge_x, edge_y = x[2 * j] - x[2 * i], x[2 * j + 1] - x[2 * i + 1]
                b = (((centroid[0] - x[2 * i]) * edge_x + (centroid[1] - x[2 * i + 1]) * edge_y)
                     / (edge_x * edge_x + edge_y * edge_y))
                for r in range(3):
                    m = (t[3 * i + r] + t[3 * j + r]) / 3.0
                    if pair == 0:
                        m += m2[r]
                    e[9 * i + 3 * j + r] += (1.0 - 1.5 * b) * m
                    e[9 * j + 3 * i + r] += (1.5 * b - 0.5) * m
                    s[3 * i + r] += 0.5 * m
                    s[3 * j + r] += 0.5 * m
                    f[3 * i + r] -= 0.5 * (1.0 - b) * m
                    f[3 * j + r] -= 0.5 * b * m
            for i in range(3):
                v = order[i]
                for r in range(3):
                    si = s[3 * i + r] + t[3 * i + r] / 3.0
                    m = f[3 * i + r] + si
                    first, second = si * (centroid[0] - x[2 * i]), si * (centroid[1] - x[2 * i + 1])
                    for j in range(3):
                        if j != i:
                            b = e[9 * i + 3 * j + r]
                            m += b
                            first += b * (x[2 * j] - x[2 * i])
                            second += b * (x[2 * j + 1] - x[2 * i + 1])
                    out[p, v, r, 0], out[p, v, r, 1], out[p, v, r, 2] = m, first / 3.0, second / 3.0
