// Sector of a disk of radius 1 with an opening of 60 degrees, of order 2.
// gmsh -2 -order 2 sector.geo -o sector.msh
SetFactory("Built-in");
angle = Pi / 3;
h = 0.1;
Point(1) = {0, 0, 0, h/2};
Point(2) = {1, 0, 0, h};
Point(3) = {Cos(angle), Sin(angle), 0, h};
Line(1) = {1, 2};
Circle(2) = {2, 1, 3};
Line(3) = {3, 1};
Curve Loop(1) = {1:3};
Plane Surface(1) = {1};

Physical Surface("plate") = {1};
Physical Curve("straight") = {1, 3};
Physical Curve("arc") = {2};
Physical Curve("edge") = {1:3};
Physical Point("tip") = {1};
