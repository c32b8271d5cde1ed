// A quarter of the hemisphere with a hole of 18 degrees: radius 10; triangles of order 2.
// gmsh -2 -order 2 hemisphere_hole.geo -o hemisphere_hole.msh
SetFactory("Built-in");
R = 10; hole = 18 * Pi / 180;
n = 12;
Point(1) = {R, 0, 0};
Point(2) = {0, R, 0};
Point(3) = {R * Sin(hole), 0, R * Cos(hole)};
Point(4) = {0, R * Sin(hole), R * Cos(hole)};
Point(8) = {0, 0, R * Cos(hole)};
Point(9) = {0, 0, 0};
Circle(1) = {1, 9, 2};
Circle(2) = {2, 9, 4};
Circle(3) = {3, 8, 4};
Circle(4) = {1, 9, 3};
Curve Loop(1) = {1, 2, -3, -4};
Surface(1) = {1} In Sphere {9};
Transfinite Curve {1, 2, 3, 4} = n + 1;
Transfinite Surface {1} AlternateRight;
Physical Surface("shell") = {1};
Physical Curve("equator") = {1};
Physical Curve("x = 0") = {2};
Physical Curve("hole") = {3};
Physical Curve("y = 0") = {4};
Physical Point("pull") = {1};
Physical Point("push") = {2};
