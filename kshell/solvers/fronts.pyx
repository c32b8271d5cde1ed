# cython: language_level=3, boundscheck=False, wraparound=False, cdivision=True, initializedcheck=False
"""The loops of kshell.solvers.frontal that find what a factor looks like, from the pattern of the matrix alone.

Symbols
-------
block    neighbouring columns with one pattern below them; they go through everything together
node     of the tree of elimination: blocks that are eliminated at once, in one dense front
"""

from libc.stdint cimport int32_t, int64_t


VERSION = 1  # as FRONTS in kshell.solvers.kernels


def alike(const int64_t[::1] indptr, const int32_t[::1] indices, int32_t[::1] block, int32_t[::1] start):
    """The block (n,) of each column, and the first column of each (n + 1,); their number.

    Columns of a block have one pattern below them, and every column before it has all of its rows or none.
    """
    cdef Py_ssize_t j, n = block.shape[0], count = 0
    cdef int64_t a, b, k, width, last
    cdef bint same
    with nogil:
        for j in range(n):  # 1 where a block begins
            block[j] = 1
            if j == 0:
                continue
            a, b = indptr[j], indptr[j - 1] + 1
            width = indptr[j + 1] - a
            same = a - b == width
            if same:
                for k in range(width):
                    if indices[a + k] != indices[b + k]:
                        same = False
                        break
            if same:
                block[j] = 0
        for j in range(n):
            if not block[j]:
                continue
            last = j - 1
            for k in range(indptr[j], indptr[j + 1]):
                if indices[k] != last + 1:
                    block[last + 1] = block[indices[k]] = 1
                last = indices[k]
            if last + 1 < n:
                block[last + 1] = 1
        for j in range(n):
            if block[j]:
                start[count] = <int32_t>j
                count += 1
            block[j] = <int32_t>(count - 1)
        start[count] = <int32_t>n
    return count


def coupled(const int64_t[::1] indptr, const int32_t[::1] indices, const int32_t[::1] block,
            const int32_t[::1] start, int64_t[::1] pointer, int32_t[::1] after):
    """Blocks behind each block that it couples with; room, or of no length, to be told how much is needed."""
    cdef Py_ssize_t b, count = pointer.shape[0] - 1
    cdef int64_t k, total = 0
    cdef int32_t last
    cdef bint write = after.shape[0] > 0
    with nogil:
        for b in range(count):
            pointer[b] = total
            last = <int32_t>b
            for k in range(indptr[start[b]], indptr[start[b] + 1]):
                if block[indices[k]] != last:
                    last = block[indices[k]]
                    if write:
                        after[total] = last
                    total += 1
        pointer[count] = total
    return total


def tree(const int64_t[::1] pointer, const int32_t[::1] after, const int32_t[::1] start, int64_t[::1] row,
         int32_t[::1] before, int32_t[::1] ancestor, int32_t[::1] parent, int64_t[::1] height):
    """Parent of each block in the tree of elimination (Liu 1986), and unknowns in its column of the factor.

    Parameters
    ----------
    row : (count + 1,), zero
    before : as long as after, room
    ancestor, parent : (count,), -1
    height : (count,), room
    """
    cdef Py_ssize_t i, j, count = parent.shape[0]
    cdef int64_t k, begin
    cdef int32_t up, next_
    with nogil:
        for k in range(pointer[count]):
            row[after[k] + 1] += 1
        for i in range(count):
            row[i + 1] += row[i]
        for j in range(count):
            for k in range(pointer[j], pointer[j + 1]):
                before[row[after[k]]] = <int32_t>j
                row[after[k]] += 1
        for i in range(count):
            begin = row[i - 1] if i else 0
            for k in range(begin, row[i]):
                up = before[k]
                while up != -1 and up < i:
                    next_ = ancestor[up]
                    ancestor[up] = <int32_t>i
                    if next_ == -1:
                        parent[up] = <int32_t>i
                    up = next_
        for i in range(count):
            height[i] = start[i + 1] - start[i]
            ancestor[i] = -1
        for i in range(count):
            begin = row[i - 1] if i else 0
            ancestor[i] = <int32_t>i
            for k in range(begin, row[i]):
                up = before[k]
                while ancestor[up] != i:
                    ancestor[up] = <int32_t>i
                    height[up] += start[i + 1] - start[i]
                    up = parent[up]


cdef inline bint _merges(double zeros, double wide, double tall, const double[::1] share,
                         const double[::1] most) noexcept nogil:
    """Whether a front of so many columns and rows, of whose entries so many are zeros, is better than two."""
    cdef double entries = wide * tall - 0.5 * wide * (wide - 1.0)
    cdef Py_ssize_t k
    for k in range(share.shape[0]):
        if wide <= most[k] and zeros <= share[k] * entries:
            return True
    return False


def merged(const int32_t[::1] parent, const int32_t[::1] start, const int64_t[::1] height, const double[::1] share,
           const double[::1] most, int32_t[::1] node, int32_t[::1] child, int32_t[::1] sibling, int64_t[::1] wide,
           int64_t[::1] tall, double[::1] zeros):
    """The node (block,) that each block is eliminated in, named by its last block; the tree of nodes.

    A block takes in the nodes of its children as long as zeros are at most a share of the entries of their front
    (Ashcraft and Grimes 1989), which depends on how wide it is.

    Parameters
    ----------
    share, most : shares, and the columns up to which each holds
    node : (count,) room
    child, sibling : (count + 1,), -1: first child, and the next one of the same parent; those of the last are roots
    wide, tall, zeros : (count,) room
    """
    cdef Py_ssize_t b, count = parent.shape[0]
    cdef int32_t c, next_, kept, up, deep, last
    cdef double added
    with nogil:
        for b in range(count):
            node[b] = <int32_t>b
            wide[b] = start[b + 1] - start[b]
            tall[b] = height[b]
            zeros[b] = 0.0
            c, kept = child[b], -1
            while c != -1:
                next_ = sibling[c]
                added = <double>wide[c] * <double>(wide[c] + tall[b] - tall[c])
                if _merges(zeros[b] + zeros[c] + added, <double>(wide[b] + wide[c]), <double>(tall[b] + wide[c]),
                           share, most):
                    node[c] = <int32_t>b
                    wide[b] += wide[c]
                    tall[b] += wide[c]
                    zeros[b] += zeros[c] + added
                    deep = child[c]
                    while deep != -1:  # its children are this node's
                        last = sibling[deep]
                        sibling[deep] = kept
                        kept = deep
                        deep = last
                else:
                    sibling[c] = kept
                    kept = c
                c = next_
            child[b] = kept
            up = parent[b] if parent[b] != -1 else <int32_t>count
            sibling[b] = child[up]
            child[up] = <int32_t>b
        for b in range(count - 1, -1, -1):  # parents come behind
            node[b] = node[node[b]]


def ordered(int32_t[::1] child, const int32_t[::1] sibling, int32_t[::1] stack, int32_t[::1] nodes):
    """Nodes, children before parents; their number. First children are taken away on the way."""
    cdef Py_ssize_t count = sibling.shape[0] - 1
    cdef Py_ssize_t top = 0, done = 0
    cdef int32_t b
    with nogil:
        stack[0] = <int32_t>count
        while top >= 0:
            b = stack[top]
            if child[b] != -1:
                top += 1
                stack[top] = child[b]
                child[b] = sibling[child[b]]
                continue
            if b != count:
                nodes[done] = b
                done += 1
            top -= 1
    return done


cdef void _sort(int32_t* a, Py_ssize_t n) noexcept nogil:
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


def rows(const int64_t[::1] pointer, const int32_t[::1] after, const int32_t[::1] place, const int32_t[::1] order,
         const int32_t[::1] first, const int32_t[::1] above, int32_t[::1] mark, int32_t[::1] head, int32_t[::1] next_,
         int64_t[::1] begin, int32_t[::1] left):
    """Blocks, by their places, that are left in each front, ascending; their number.

    Parameters
    ----------
    pointer, after : as of `coupled`
    place, order : of blocks among all, and the block in each place
    first : (nodes + 1,) place of the first block of each node
    above : (nodes,) parent
    mark : (count,), -1
    head, next_ : (nodes,), -1
    begin : (nodes + 1,) room: where those of each front begin
    left : room
    """
    cdef Py_ssize_t s, b, count = above.shape[0]
    cdef int64_t k, total = 0
    cdef int32_t c, at, end
    with nogil:
        for s in range(count):
            begin[s] = total
            end = first[s + 1]
            for b in range(first[s], end):
                for k in range(pointer[order[b]], pointer[order[b] + 1]):
                    at = place[after[k]]
                    if at >= end and mark[at] != s:
                        mark[at] = <int32_t>s
                        left[total] = at
                        total += 1
            c = head[s]
            while c != -1:
                for k in range(begin[c], begin[c + 1]):
                    at = left[k]
                    if at >= end and mark[at] != s:
                        mark[at] = <int32_t>s
                        left[total] = at
                        total += 1
                c = next_[c]
            begin[s + 1] = total
            if total > begin[s]:
                _sort(&left[begin[s]], total - begin[s])
            if above[s] != -1:
                next_[s] = head[above[s]]
                head[above[s]] = <int32_t>s
    return total


def room(const int32_t[::1] above, const int64_t[::1] m, int32_t[::1] side, int64_t[::1] update, int64_t[::1] freed):
    """Where the update (m, m) of each front lies in one array, from its left or its right end; how long that has to be.

    Children lie on the other side than their parent, on which nothing came after them.

    Parameters
    ----------
    side, update : (nodes,) room
    freed : (nodes,), zero
    """
    cdef Py_ssize_t s, count = above.shape[0]
    cdef int64_t most = 0, size
    cdef int64_t[2] used
    used[0] = used[1] = 0
    with nogil:
        for s in range(count - 1, -1, -1):
            side[s] = 1 - side[above[s]] if above[s] != -1 else 0
        for s in range(count):
            size = m[s] * m[s]
            update[s] = used[side[s]]
            used[side[s]] += size
            if used[0] + used[1] > most:
                most = used[0] + used[1]
            used[1 - side[s]] -= freed[s]
            if above[s] != -1:
                freed[above[s]] += size
        for s in range(count):
            if side[s]:
                update[s] = most - update[s] - m[s] * m[s]
    return most
