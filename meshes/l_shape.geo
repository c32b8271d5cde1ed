// L-shape: the square (-1, 1) x (-1, 1) without its quarter x > 0, y < 0; finer at the re-entrant corner.
// gmsh -2 l_shape.geo -o l_shape.msh
SetFactory("Built-in");
h = 0.2;
Point(1) = {0, 0, 0, h/4};
Point(2) = {1, 0, 0, h};
Point(3) = {1, 1, 0, h};
Point(4) = {-1, 1, 0, h};
Point(5) = {-1, -1, 0, h};
Point(6) = {0, -1, 0, h};
Line(1) = {1, 2};
Line(2) = {2, 3};
Line(3) = {3, 4};
Line(4) = {4, 5};
Line(5) = {5, 6};
Line(6) = {6, 1};
Curve Loop(1) = {1:6};
Plane Surface(1) = {1};

Physical Surface("plate") = {1};
Physical Curve("edge") = {1:6};
Physical Curve("reentrant") = {1, 6};
Physical Point("corner") = {1};
