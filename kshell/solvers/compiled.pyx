# cython: language_level=3, boundscheck=False, wraparound=False, cdivision=True, initializedcheck=False
"""The loops of kshell.solvers.kernels, compiled. They make what its functions of numpy make, number by number."""

cimport cython
from libc.math cimport INFINITY
from libc.stdint cimport int32_t, int64_t


VERSION = 3  # as in kshell.solvers.kernels


cdef void _sort(int32_t* a, Py_ssize_t n) noexcept nogil:
    """Insertion sort, for the few neighbours of one group; beyond that by halving steps (Shell)."""
    cdef Py_ssize_t gap = 1, i, j
    cdef int32_t x
    while gap < n // 3:
        gap = 3 * gap + 1
    while gap > 0:
        for i in range(gap, n):
            x = a[i]
            j = i
            while j >= gap and a[j - gap] > x:
                a[j] = a[j - gap]
                j -= gap
            a[j] = x
        gap //= 3


def neighbours(const int32_t[:, ::1] groups, int64_t[::1] starts, int32_t[::1] elements, int32_t[::1] mark,
               int64_t[::1] pairs, int32_t[::1] high, bint before=False):
    """Groups that each group meets in an element, in order, those before it only if wanted; their number.

    Parameters
    ----------
    groups : (element, g)
    starts : (count + 1,), zero
    elements : (element * g,), room
    mark : (count,), -1
    pairs : (count + 1,), room: where those of each group start
    high : room for the groups, or of no length, to be told how much is needed
    """
    cdef Py_ssize_t n = groups.shape[0], g = groups.shape[1], count = mark.shape[0]
    cdef Py_ssize_t e, k, a, i, begin
    cdef int64_t total = 0
    cdef int32_t other
    cdef bint write = high.shape[0] > 0
    with nogil:
        for e in range(n):
            for k in range(g):
                starts[groups[e, k] + 1] += 1
        for a in range(count):
            starts[a + 1] += starts[a]
        for e in range(n):
            for k in range(g):
                a = groups[e, k]
                elements[starts[a]] = <int32_t>e
                starts[a] += 1
        for a in range(count):
            begin = starts[a - 1] if a else 0
            pairs[a] = total
            mark[a] = <int32_t>a
            if write:
                high[total] = <int32_t>a
            total += 1
            for i in range(begin, starts[a]):
                e = elements[i]
                for k in range(g):
                    other = groups[e, k]
                    if (before or other > a) and mark[other] != a:
                        mark[other] = <int32_t>a
                        if write:
                            high[total] = other
                        total += 1
            if write:
                _sort(&high[pairs[a]], total - pairs[a])
        pairs[count] = total
    return total


def numbers(const int32_t[:, ::1] groups, const int64_t[::1] pairs, const int32_t[::1] high,
            int32_t[:, :, ::1] place):
    """The number of each pair of groups of each element, by halving in the sorted neighbours of the lower group."""
    cdef Py_ssize_t e, i, j, low, top, middle
    cdef int32_t a, b
    with nogil:
        for e in range(groups.shape[0]):
            for i in range(groups.shape[1]):
                for j in range(i + 1):
                    a, b = groups[e, i], groups[e, j]
                    if a > b:
                        a, b = b, a
                    low, top = pairs[a], pairs[a + 1] - 1
                    while low < top:
                        middle = (low + top) // 2
                        if high[middle] < b:
                            low = middle + 1
                        else:
                            top = middle
                    place[e, i, j] = <int32_t>low
                    place[e, j, i] = <int32_t>low


def columns(const int64_t[::1] pairs, const int32_t[::1] high, const int64_t[::1] counts, const int64_t[::1] first,
            int32_t[::1] indices):
    """Rows of the compressed columns of the lower triangle between groups of unknowns."""
    cdef Py_ssize_t a, p, i, b
    cdef int64_t at = 0
    with nogil:
        for a in range(counts.shape[0]):
            for i in range(counts[a]):
                for b in range(i, counts[a]):
                    indices[at] = <int32_t>(first[a] + b)
                    at += 1
                for p in range(pairs[a] + 1, pairs[a + 1]):
                    for b in range(counts[high[p]]):
                        indices[at] = <int32_t>(first[high[p]] + b)
                        at += 1


def add_lower(double[::1] data, const int32_t[:, ::1] unknowns, const int32_t[::1] number, const int32_t[::1] base,
              const int32_t[::1] within, const int32_t[::1] left, const int32_t[:, :, ::1] pair,
              const int64_t[::1] member, const double[:, :, ::1] matrices):
    """Add element matrices to the entries of the lower triangle; what is held, with a negative number, falls away."""
    cdef Py_ssize_t e, i, j, n = member.shape[0]
    cdef int32_t a, b, step
    with nogil:
        for e in range(unknowns.shape[0]):
            for i in range(n):
                a = number[unknowns[e, i]]
                if a < 0:
                    continue
                for j in range(i, n):
                    b = number[unknowns[e, j]]
                    if b < 0:
                        continue
                    step = left[pair[e, member[i], member[j]]]
                    if b < a:
                        data[base[b] + within[a] + step] += matrices[e, i, j]
                    else:
                        data[base[a] + within[b] + step] += matrices[e, i, j]


def cut_places(const int32_t[::1] position, const int32_t[::1] owners, const int64_t[::1] starts,
               const int64_t[::1] bounds, double reach, double uneven, int64_t[::1] straddling, double[::1] least,
               int64_t[::1] first):
    """Where each part is best cut across one axis: what it costs there, and the place of the last element before it.

    Parameters
    ----------
    position : (element,) place of each in the order along the axis
    owners, starts : elements of each thing that lie in one part, behind each other
    bounds : (part + 1,)
    reach : share of a part by which a cut may lie off its middle
    straddling : (element,) zero
    least, first : (part,) room
    """
    cdef Py_ssize_t k, i, part
    cdef int64_t low, high, at, size
    cdef int64_t open_ = 0
    cdef double off, cost, best, most
    with nogil:
        for k in range(starts.shape[0] - 1):
            low = high = position[owners[starts[k]]]
            for i in range(starts[k] + 1, starts[k + 1]):
                at = position[owners[i]]
                if at < low:
                    low = at
                elif at > high:
                    high = at
            straddling[low] += 1
            straddling[high] -= 1
        for part in range(bounds.shape[0] - 1):
            size = bounds[part + 1] - bounds[part]
            most = 0.51 / size
            if reach > most:
                most = reach
            best = INFINITY
            least[part] = best
            first[part] = bounds[part]
            for i in range(bounds[part], bounds[part + 1]):
                open_ += straddling[i]
                off = (<double>(i - bounds[part] + 1)) / (<double>size) - 0.5
                if off < 0.0:
                    off = -off
                if off <= most and i + 1 < bounds[part + 1]:
                    cost = open_ * (1.0 + uneven * off)
                    if cost < best:
                        best = cost
                        least[part] = cost
                        first[part] = i


def halved(const int32_t[::1] order, const cython.uchar[::1] beyond, const int64_t[::1] bounds, const int64_t[::1] middle,
           int32_t[::1] result):
    """The order with the elements beyond the cut of each group moved to its end, otherwise unchanged."""
    cdef Py_ssize_t part, i
    cdef int64_t before, behind
    with nogil:
        for part in range(middle.shape[0]):
            before, behind = bounds[part], middle[part]
            for i in range(bounds[part], bounds[part + 1]):
                if beyond[order[i]]:
                    result[behind] = order[i]
                    behind += 1
                else:
                    result[before] = order[i]
                    before += 1


def rows_of_nodes(const int64_t[::1] pairs, const int32_t[::1] near, const int64_t[::1] sizes, const int64_t[::1] starts,
                  int32_t[::1] indptr, int32_t[::1] indices):
    """Compressed rows of a matrix in which nodes couple as blocks; the number of entries.

    Parameters
    ----------
    pairs, near : nodes that each node couples with, sorted
    sizes, starts : (node,) and (node + 1,) unknowns of each node, and where they begin
    indptr, indices : room, or indices of no length, to be told how much is needed
    """
    cdef Py_ssize_t a, p, i, j
    cdef int64_t total = 0, width
    cdef bint write = indices.shape[0] > 0
    with nogil:
        for a in range(sizes.shape[0]):
            if sizes[a] == 0:
                continue
            if not write:
                width = 0
                for p in range(pairs[a], pairs[a + 1]):
                    width += sizes[near[p]]
                total += width * sizes[a]
                continue
            for i in range(sizes[a]):
                for p in range(pairs[a], pairs[a + 1]):
                    for j in range(starts[near[p]], starts[near[p] + 1]):
                        indices[total] = <int32_t>j
                        total += 1
                indptr[starts[a] + i + 1] = <int32_t>total
    return total


def add_nodes(double[::1] data, const int32_t[::1] indptr, const int32_t[::1] indices, const int64_t[::1] starts,
              const int32_t[:, ::1] nodes, const int64_t[::1] node, const int32_t[:, ::1] unknown,
              const double[:, :, ::1] matrices):
    """Add element matrices to compressed rows in which nodes couple as blocks; what is fixed falls away.

    Parameters
    ----------
    nodes : (element, m), at most 8 of them
    node : (n,) which of these each column of the matrices belongs to
    unknown : (element, n) number or -1
    """
    cdef Py_ssize_t e, i, j, k, n = node.shape[0], m = nodes.shape[1]
    cdef int64_t row, low, top, middle, first
    cdef int64_t[8] at  # from the first entry of a row to the blocks of the nodes
    cdef int32_t known
    with nogil:
        for e in range(matrices.shape[0]):
            known = -1
            for i in range(n):
                row = unknown[e, i]
                if row < 0:
                    continue
                if node[i] != known:
                    known = <int32_t>node[i]
                    for k in range(m):
                        first = starts[nodes[e, k]]
                        low, top = indptr[row], indptr[row + 1]
                        while low < top:
                            middle = (low + top) // 2
                            if indices[middle] < first:
                                low = middle + 1
                            else:
                                top = middle
                        at[k] = low - indptr[row] - first
                for j in range(n):
                    if unknown[e, j] >= 0:
                        data[indptr[row] + at[node[j]] + unknown[e, j]] += matrices[e, i, j]
