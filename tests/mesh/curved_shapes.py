"""Meshes of flat triangles on surfaces that are known, with the distance from them."""

import numpy as np


def grid_triangles(n, m, around):
    """Triangles of n x m cells between vertices numbered row by row; closed in the first direction if `around`."""
    wide = n if around else n + 1
    i, j = np.meshgrid(np.arange(n), np.arange(m))
    a = (j * wide + i).ravel()
    b = (j * wide + (i + 1) % wide).ravel()
    return np.concatenate([np.stack([a, b, b + wide], axis=1), np.stack([a, b + wide, a + wide], axis=1)])


def cylinder(n, m, length=2.0, radius=1.0):
    """A structured tube about z."""
    phi, z = np.arange(n) * 2 * np.pi / n, np.linspace(0, length, m + 1)
    around, along = np.meshgrid(phi, z)
    points = np.stack([radius * np.cos(around), radius * np.sin(around), along], axis=-1)
    return points.reshape(-1, 3), grid_triangles(n, m, True)


def off_cylinder(x, radius=1.0):
    return np.hypot(x[:, 0], x[:, 1]) - radius


def sphere(n):
    """An octahedron with its faces divided n times, put on the unit sphere, and shaken along it."""
    index, points, triangles = {}, [], []

    def at(*corner):
        if corner not in index:
            index[corner] = len(points)
            points.append(np.array(corner, float) / np.linalg.norm(corner))
        return index[corner]

    for s in np.array(np.meshgrid([1, -1], [1, -1], [1, -1])).reshape(3, -1).T:
        for i in range(n):
            for j in range(n - i):

                def node(i, j, s=s):
                    return at(int(s[0] * i), int(s[1] * j), int(s[2] * (n - i - j)))

                part = [[node(i, j), node(i + 1, j), node(i, j + 1)]]
                if i + j < n - 1:
                    part.append([node(i + 1, j), node(i + 1, j + 1), node(i, j + 1)])
                triangles += [t if s.prod() > 0 else t[::-1] for t in part]
    x = np.array(points)
    x += np.random.default_rng(0).uniform(-0.2, 0.2, x.shape) / n
    return x / np.linalg.norm(x, axis=1)[:, None], np.array(triangles)


def off_sphere(x):
    return np.linalg.norm(x, axis=1) - 1


def sheet(xs, ys, z):
    """z(x) over a grid."""
    x, y = np.meshgrid(xs, ys)
    points = np.stack([x, y, z(x)], axis=-1).reshape(-1, 3)
    return points, grid_triangles(len(xs) - 1, len(ys) - 1, False)


def dented_plate(over_flat, along):
    """A plate with a groove, an arc of radius 1 that meets the flats at an angle."""
    xs = np.concatenate(
        [
            np.linspace(-1, -0.4, over_flat + 1),
            np.linspace(-0.4, 0.4, 9)[1:],
            np.linspace(0.4, 1, over_flat + 1)[1:],
        ]
    )

    def z(x):
        return np.where(np.abs(x) < 0.4, np.sqrt(0.84) - np.sqrt(np.maximum(1 - x**2, 0)), 0)

    return sheet(xs, np.linspace(0, 1, along + 1), z)


def off_dented_plate(x):
    arc = np.hypot(x[:, 0], x[:, 2] - np.sqrt(0.84)) - 1
    return np.where(np.abs(x[:, 0]) < 0.4, arc, x[:, 2])


def stadium(over_flat, over_arc, along, radius=0.3):
    """A tube of two flats of width 1 and two half circles."""
    s = np.linspace(0, 1, over_flat + 1)[:-1]
    f = np.linspace(0, np.pi, over_arc + 1)[:-1]
    outline = np.concatenate(
        [
            np.stack([s, 0 * s - radius], axis=1),
            np.stack([1 + radius * np.sin(f), -radius * np.cos(f)], axis=1),
            np.stack([1 - s, 0 * s + radius], axis=1),
            np.stack([-radius * np.sin(f), radius * np.cos(f)], axis=1),
        ]
    )
    n = len(outline)
    points = np.concatenate([np.column_stack([outline, np.full(n, z)]) for z in np.linspace(0, 1, along + 1)])
    return points, grid_triangles(n, along, True)


def off_stadium(x, radius=0.3):
    return np.hypot(x[:, 0] - np.clip(x[:, 0], 0, 1), x[:, 1]) - radius


def by_gmsh(build, size):
    """Triangles of the surfaces of what `build(occ)` makes."""
    import gmsh

    gmsh.initialize()
    try:
        gmsh.option.setNumber("General.Terminal", 0)
        build(gmsh.model.occ)
        gmsh.model.occ.synchronize()
        gmsh.option.setNumber("Mesh.MeshSizeMax", size)
        gmsh.option.setNumber("Mesh.MeshSizeMin", size / 3)
        gmsh.model.mesh.generate(2)
        tags, x, _ = gmsh.model.mesh.getNodes()
        triangles = gmsh.model.mesh.getElementsByType(2)[1].reshape(-1, 3)
    finally:
        gmsh.finalize()
    used, triangles = np.unique(triangles, return_inverse=True)
    row = dict(zip(tags.tolist(), range(len(tags)), strict=True))
    return x.reshape(-1, 3)[[row[tag] for tag in used.tolist()]], triangles.reshape(-1, 3)


def can(occ):
    occ.addCylinder(0, 0, 0, 0, 0, 2, 1)


def off_can(x):
    r, z = np.hypot(x[:, 0], x[:, 1]) - 1, np.abs(x[:, 2] - 1) - 1
    return np.where((r > 0) & (z > 0), np.hypot(r, z), np.maximum(r, z))


def capsule(occ):
    occ.fuse(
        [(3, occ.addCylinder(0, 0, 0, 0, 0, 2, 1))],
        [(3, occ.addSphere(0, 0, 0, 1)), (3, occ.addSphere(0, 0, 2, 1))],
    )


def off_capsule(x):
    return np.linalg.norm(x - np.clip(x[:, 2], 0, 2)[:, None] * [0, 0, 1], axis=1) - 1


def tee(occ):
    """Two tubes that meet along a curve in space, with flat ends."""
    occ.fuse([(3, occ.addCylinder(0, 0, -2, 0, 0, 4, 1))], [(3, occ.addCylinder(0, 0, 0, 2, 0, 0, 0.6))])


def off_tee(x):
    run = np.where(np.abs(x[:, 2]) > 2 - 1e-6, 0, np.hypot(x[:, 0], x[:, 1]) - 1)
    branch = np.hypot(x[:, 1], x[:, 2]) - 0.6
    branch = np.where(x[:, 0] > 2 - 1e-6, 0, np.where(x[:, 0] > 0.7, branch, 9))
    return np.minimum(run, branch)


def cone(occ):
    """A tube that goes over into a cone with a crease of 20 degrees."""
    top = 1 - np.tan(np.radians(20))
    occ.fuse([(3, occ.addCylinder(0, 0, 0, 0, 0, 1, 1))], [(3, occ.addCone(0, 0, 1, 0, 0, 1, 1, top))])


def off_cone(x):
    r, z, slope = np.hypot(x[:, 0], x[:, 1]), x[:, 2], np.radians(20)
    side = np.where(z < 1, r - 1, (r - 1 + (z - 1) * np.tan(slope)) * np.cos(slope))
    return np.where((z < 1e-9) | (z > 2 - 1e-9), 0, side)


def rounded_box(occ):
    box = occ.addBox(-0.5, -0.5, -0.5, 1, 1, 1)
    occ.fillet([box], [tag for _, tag in occ.getEntities(1)], [0.2])


def off_rounded_box(x):
    q = np.abs(x) - 0.3
    return np.linalg.norm(np.maximum(q, 0), axis=1) + np.minimum(q.max(axis=1), 0) - 0.2
