// Annulus between the radii 0.4 and 1, of order 2.
// gmsh -2 -order 2 annulus.geo -o annulus.msh
SetFactory("OpenCASCADE");
Disk(1) = {0, 0, 0, 1};
Disk(2) = {0, 0, 0, 0.4};
BooleanDifference(3) = { Surface{1}; Delete; }{ Surface{2}; Delete; };
Mesh.MeshSizeMax = 0.16;

outer() = Curve In BoundingBox {-1.01, -1.01, -0.01, 1.01, 1.01, 0.01};
inner() = Curve In BoundingBox {-0.41, -0.41, -0.01, 0.41, 0.41, 0.01};
outer() -= inner();
Physical Surface("plate") = {3};
Physical Curve("outer") = {outer()};
Physical Curve("inner") = {inner()};
