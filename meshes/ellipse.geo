// Ellipse with the half-axes 2 and 1, of order 2.
// gmsh -2 -order 2 ellipse.geo -o ellipse.msh
SetFactory("Built-in");
h = 0.2;
Point(1) = {0, 0, 0, h};
Point(2) = {2, 0, 0, h};
Point(3) = {0, 1, 0, h};
Point(4) = {-2, 0, 0, h};
Point(5) = {0, -1, 0, h};
Ellipse(1) = {2, 1, 2, 3};
Ellipse(2) = {3, 1, 4, 4};
Ellipse(3) = {4, 1, 4, 5};
Ellipse(4) = {5, 1, 2, 2};
Curve Loop(1) = {1:4};
Plane Surface(1) = {1};
Point{1} In Surface{1};

Physical Surface("plate") = {1};
Physical Curve("edge") = {1:4};
Physical Point("centre") = {1};
