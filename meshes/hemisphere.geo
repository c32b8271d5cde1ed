// A quarter of the full hemisphere: radius 10; triangles of order 2.
// gmsh -2 -order 2 hemisphere.geo -o hemisphere.msh
SetFactory("Built-in");
R = 10; h = 0.95;
Point(1) = {R, 0, 0, h};
Point(2) = {0, R, 0, h};
Point(3) = {0, 0, R, h};
Point(9) = {0, 0, 0};
Circle(1) = {1, 9, 2};
Circle(2) = {2, 9, 3};
Circle(3) = {3, 9, 1};
Curve Loop(1) = {1, 2, 3};
Surface(1) = {1} In Sphere {9};
Physical Surface("shell") = {1};
Physical Curve("equator") = {1};
Physical Curve("x = 0") = {2};
Physical Curve("y = 0") = {3};
Physical Point("pull") = {1};
Physical Point("push") = {2};
