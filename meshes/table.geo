// The top of a table and its sides, as an obstacle: 0.6 by 0.6, 0.02 below z = 0.
// gmsh -2 table.geo -o table.msh
SetFactory("Built-in");
Point(1) = {-0.1, -0.1, -0.02, 1};
Point(2) = {0.55, -0.1, -0.02, 1};
Point(3) = {0.55, 0.55, -0.02, 1};
Point(4) = {-0.1, 0.55, -0.02, 1};
Line(1) = {1, 2};
Line(2) = {2, 3};
Line(3) = {3, 4};
Line(4) = {4, 1};
Curve Loop(1) = {1:4};
Plane Surface(1) = {1};
out() = Extrude {0, 0, -0.8} { Surface{1}; };
Physical Surface("table") = {1, out(2), out(3), out(4), out(5)};
