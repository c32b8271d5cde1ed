# cython: language_level=3, boundscheck=False, wraparound=False, cdivision=True, initializedcheck=False
"""The loops of kshell.mesh.triangulation and kshell.mesh.connected, compiled. They make what numpy makes there."""

from libc.stdint cimport int32_t, int64_t


VERSION = 1  # as in kshell.mesh.kernels


cdef void _sort(int64_t* a, Py_ssize_t n) noexcept nogil:
    """Insertion sort, for the few edges of one vertex; beyond that by halving steps (Shell)."""
    cdef Py_ssize_t gap = 1, i, j
    cdef int64_t x
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


def edges_of(const int32_t[:, ::1] triangles, int64_t[::1] starts, int64_t[::1] places, int32_t[:, ::1] edges,
             int32_t[:, ::1] of_triangles, int32_t[::1] counts, int64_t[:, ::1] sides):
    """All of an `EdgeTable`; the number of edges, or -1 where a triangle names a vertex that is none.

    Parameters
    ----------
    triangles : (triangle, 3)
    starts : (vertex + 1,), zero
    places : (3 triangle,), room
    edges, of_triangles, counts, sides : room for 3 edges per triangle
    """
    cdef Py_ssize_t n = triangles.shape[0], vertices = starts.shape[0] - 1
    cdef Py_ssize_t t, k, v, i, begin, end
    cdef int64_t all_places = 3 * n, upper, last, place, found = -1
    cdef int32_t[3] first = [0, 1, 0]
    cdef int32_t[3] second = [1, 2, 2]
    cdef int32_t a, b
    with nogil:
        for t in range(n):
            for k in range(3):
                a, b = triangles[t, first[k]], triangles[t, second[k]]
                if a < 0 or b < 0 or a >= vertices or b >= vertices:
                    with gil:
                        return -1
                starts[(a if a < b else b) + 1] += 1
        for v in range(vertices):
            starts[v + 1] += starts[v]
        for t in range(n):
            for k in range(3):
                a, b = triangles[t, first[k]], triangles[t, second[k]]
                v = a if a < b else b
                places[starts[v]] = (b if a < b else a) * all_places + 3 * t + k
                starts[v] += 1  # in the end where the next vertex begins
        begin = 0
        for v in range(vertices):
            end = starts[v]
            _sort(&places[begin] if end > begin else NULL, end - begin)
            last = -1
            for i in range(begin, end):
                upper = places[i] // all_places
                place = places[i] - upper * all_places
                if upper != last:
                    last = upper
                    found += 1
                    edges[found, 0], edges[found, 1] = <int32_t>v, <int32_t>upper
                    counts[found] = 0
                    sides[0, found] = place
                counts[found] += 1
                sides[1, found] = place
                of_triangles[place // 3, place % 3] = <int32_t>found
            begin = end
    return found + 1


def parts_of(const int64_t[::1] first, const int64_t[::1] second, int64_t[::1] part):
    """Numbers of the connected parts of a graph, by their lowest nodes; how many there are, or -1 for a link to nothing.

    Parameters
    ----------
    first, second : (link,)
    part : (node,), room
    """
    cdef Py_ssize_t n = part.shape[0], k
    cdef int64_t a, b, found = 0
    with nogil:
        for k in range(n):
            part[k] = k
        for k in range(first.shape[0]):
            a, b = first[k], second[k]
            if a < 0 or b < 0 or a >= n or b >= n:
                with gil:
                    return -1
            while part[a] != a:
                part[a] = part[part[a]]
                a = part[a]
            while part[b] != b:
                part[b] = part[part[b]]
                b = part[b]
            if a < b:
                part[b] = a
            elif b < a:
                part[a] = b
        for k in range(n):  # roots are lowest: those of later nodes are numbered already
            if part[k] == k:
                part[k] = found
                found += 1
            else:
                part[k] = part[part[k]]
    return found
