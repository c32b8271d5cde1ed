# cython: language_level=3, boundscheck=False, wraparound=False, cdivision=True, initializedcheck=False
"""The loops of kshell.solvers.frontal with numbers: fronts made, eliminated and handed on, and solutions.

Dense products are those of the BLAS and LAPACK of scipy, found when this is imported.

Symbols
-------
node     of the tree of elimination: what is eliminated at once, in one dense front
p, m     unknowns eliminated in a front, and those that are left in it
panel    (p + m, p), the columns of the factor; update: (m, m), lower triangle of what the front hands to its parent
"""

from libc.math cimport INFINITY
from libc.stdint cimport int32_t, int64_t
from libc.string cimport memset


cdef extern from "Python.h":
    void* PyCapsule_GetPointer(object, const char*) except NULL
    const char* PyCapsule_GetName(object) except NULL

ctypedef void (*potrf_t)(char*, int*, double*, int*, int*) noexcept nogil
ctypedef void (*trsm_t)(char*, char*, char*, char*, int*, int*, double*, double*, int*, double*, int*) noexcept nogil
ctypedef void (*syrk_t)(char*, char*, int*, int*, double*, double*, int*, double*, double*, int*) noexcept nogil
ctypedef void (*gemm_t)(char*, char*, int*, int*, int*, double*, double*, int*, double*, int*, double*, double*,
                        int*) noexcept nogil
ctypedef void (*trsv_t)(char*, char*, char*, int*, double*, int*, double*, int*) noexcept nogil
ctypedef void (*gemv_t)(char*, int*, int*, double*, double*, int*, double*, int*, double*, double*,
                        int*) noexcept nogil

VERSION = 1  # as FRONTS in kshell.solvers.kernels

cdef potrf_t dpotrf
cdef trsm_t dtrsm
cdef syrk_t dsyrk
cdef gemm_t dgemm
cdef trsv_t dtrsv
cdef gemv_t dgemv


cdef void* _found(object module, str name) except NULL:
    """A function that scipy offers to compiled code."""
    try:
        capsule = module.__pyx_capi__[name]
    except (AttributeError, KeyError) as error:
        raise ImportError(f"scipy has no {name} for compiled code") from error
    return PyCapsule_GetPointer(capsule, PyCapsule_GetName(capsule))


def _link():
    global dpotrf, dtrsm, dsyrk, dgemm, dtrsv, dgemv
    from scipy.linalg import cython_blas, cython_lapack

    dpotrf = <potrf_t>_found(cython_lapack, "dpotrf")
    dtrsm = <trsm_t>_found(cython_blas, "dtrsm")
    dsyrk = <syrk_t>_found(cython_blas, "dsyrk")
    dgemm = <gemm_t>_found(cython_blas, "dgemm")
    dtrsv = <trsv_t>_found(cython_blas, "dtrsv")
    dgemv = <gemv_t>_found(cython_blas, "dgemv")


_link()


def factorise(const int64_t[::1] indptr, const int32_t[::1] indices, const double[::1] data,
              const int32_t[::1] unknown, const int32_t[::1] place, const int32_t[::1] first,
              const int64_t[::1] begin, const int32_t[::1] left, const int32_t[::1] start,
              const int64_t[::1] panel, const int64_t[::1] update, const int32_t[::1] child,
              const int32_t[::1] sibling, int32_t[::1] local, int64_t[::1] runs, double[::1] factor,
              double[::1] stack):
    """The factor; the first unknown whose pivot is not positive and finite, or -1.

    Parameters
    ----------
    indptr, indices, data : compressed columns of the lower triangle
    unknown, place : (n,) column of the matrix in each place, and the other way round
    first : (nodes + 1,) first place of each node
    begin, left : blocks that are left in each front
    start : (blocks + 1,) first place of each block
    panel, update : where those of each node begin
    child, sibling : (nodes,) first child, and the next one of the same parent
    local : (n,) room
    runs : room for three numbers for every block of the longest front
    factor : zero
    stack : room
    """
    cdef Py_ssize_t s, c, j, r, q, count = first.shape[0] - 1
    cdef int p, m, of_child, long_, info, column
    cdef int64_t k, n_runs, here, length, source, bad = -1
    cdef double* front
    cdef double* rest
    cdef double* given
    cdef double* to
    cdef double plus = 1.0, minus = -1.0, kept
    with nogil:
        for s in range(count):
            p, m = first[s + 1] - first[s], 0
            for j in range(p):
                local[first[s] + j] = <int32_t>j
            for k in range(begin[s], begin[s + 1]):
                for r in range(start[left[k]], start[left[k] + 1]):
                    local[r] = p + m
                    m += 1
            long_ = p + m
            front, rest = &factor[panel[s]], &stack[update[s]]
            if child[s] != -1:
                memset(rest, 0, <size_t>m * <size_t>m * sizeof(double))
            for j in range(p):
                source = unknown[first[s] + j]
                for k in range(indptr[source], indptr[source + 1]):
                    front[<int64_t>j * long_ + local[place[indices[k]]]] = data[k]
            c = child[s]
            while c != -1:
                # runs of neighbouring rows: where they begin in the child, and here, and how long they are
                n_runs, of_child = 0, 0
                for k in range(begin[c], begin[c + 1]):
                    here = local[start[left[k]]]
                    length = start[left[k] + 1] - start[left[k]]
                    if n_runs and here != p and runs[3 * n_runs - 2] + runs[3 * n_runs - 1] == here:
                        runs[3 * n_runs - 1] += length
                    else:
                        runs[3 * n_runs], runs[3 * n_runs + 1], runs[3 * n_runs + 2] = of_child, here, length
                        n_runs += 1
                    of_child += <int>length
                given = &stack[update[c]]
                for q in range(n_runs):
                    for j in range(runs[3 * q + 2]):
                        source = runs[3 * q] + j
                        column = <int>(runs[3 * q + 1] + j)
                        to = front + <int64_t>column * long_ if column < p else rest + <int64_t>(column - p) * m - p
                        _add(to + column, given + source * of_child + source, runs[3 * q + 2] - j)
                        for r in range(q + 1, n_runs):
                            _add(to + runs[3 * r + 1], given + source * of_child + runs[3 * r], runs[3 * r + 2])
                c = sibling[c]
            dpotrf("L", &p, front, &long_, &info)
            if info == 0:
                for j in range(p):
                    if not 0.0 < front[<int64_t>j * long_ + j] < INFINITY:
                        info = <int>j + 1
                        break
            if info != 0:
                bad = unknown[first[s] + (info - 1 if info > 0 else 0)]
                break
            if m:
                dtrsm("R", "L", "T", "N", &m, &p, &plus, front, &long_, front + p, &long_)
                kept = 1.0 if child[s] != -1 else 0.0  # of what is there, which may be anything where it is nothing
                dsyrk("L", "N", &m, &p, &minus, front + p, &long_, &kept, rest, &m)
    return bad


cdef inline void _add(double* to, const double* what, int64_t n) noexcept nogil:
    cdef int64_t i
    for i in range(n):
        to[i] += what[i]


def solve(const int32_t[::1] first, const int64_t[::1] begin, const int32_t[::1] left, const int32_t[::1] start,
          const int64_t[::1] panel, double[::1] factor, double[::1] work, double[::1, :] x):
    """Solutions (n, k) in place, in the order of elimination; `work` has room for the longest update and k."""
    cdef Py_ssize_t s, count = first.shape[0] - 1, c
    cdef int p, m, long_, one = 1, n = <int>x.shape[0], columns = <int>x.shape[1]
    cdef int64_t k, i
    cdef int32_t r
    cdef double plus = 1.0, minus = -1.0, zero = 0.0
    cdef double* front
    cdef double* mine
    if not n or not columns:
        return
    with nogil:
        for s in range(count):
            p, m = first[s + 1] - first[s], 0
            for k in range(begin[s], begin[s + 1]):
                m += start[left[k] + 1] - start[left[k]]
            long_ = p + m
            front, mine = &factor[panel[s]], &x[first[s], 0]
            if columns == 1:
                dtrsv("L", "N", "N", &p, front, &long_, mine, &one)
            else:
                dtrsm("L", "L", "N", "N", &p, &columns, &plus, front, &long_, mine, &n)
            if m:
                if columns == 1:
                    dgemv("N", &m, &p, &plus, front + p, &long_, mine, &one, &zero, &work[0], &one)
                else:
                    dgemm("N", "N", &m, &columns, &p, &plus, front + p, &long_, mine, &n, &zero, &work[0], &m)
                for c in range(columns):
                    i = c * <int64_t>m
                    for k in range(begin[s], begin[s + 1]):
                        for r in range(start[left[k]], start[left[k] + 1]):
                            x[r, c] -= work[i]
                            i += 1
        for s in range(count - 1, -1, -1):
            p, m = first[s + 1] - first[s], 0
            for k in range(begin[s], begin[s + 1]):
                m += start[left[k] + 1] - start[left[k]]
            long_ = p + m
            front, mine = &factor[panel[s]], &x[first[s], 0]
            if m:
                for c in range(columns):
                    i = c * <int64_t>m
                    for k in range(begin[s], begin[s + 1]):
                        for r in range(start[left[k]], start[left[k] + 1]):
                            work[i] = x[r, c]
                            i += 1
                if columns == 1:
                    dgemv("T", &m, &p, &minus, front + p, &long_, &work[0], &one, &plus, mine, &one)
                else:
                    dgemm("T", "N", &p, &columns, &m, &minus, front + p, &long_, &work[0], &m, &plus, mine, &n)
            if columns == 1:
                dtrsv("L", "T", "N", &p, front, &long_, mine, &one)
            else:
                dtrsm("L", "L", "T", "N", &p, &columns, &plus, front, &long_, mine, &n)
