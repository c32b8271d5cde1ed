// Disk of radius 1.
// gmsh -2 disk.geo -o disk.msh
// gmsh -2 -order 2 disk.geo -o disk_order2.msh
SetFactory("Built-in");
h = 0.15;
Point(1) = {0, 0, 0, h};
Point(2) = {1, 0, 0, h};
Point(3) = {0, 1, 0, h};
Point(4) = {-1, 0, 0, h};
Point(5) = {0, -1, 0, h};
Circle(1) = {2, 1, 3};
Circle(2) = {3, 1, 4};
Circle(3) = {4, 1, 5};
Circle(4) = {5, 1, 2};
Curve Loop(1) = {1:4};
Plane Surface(1) = {1};
Point{1} In Surface{1};

Physical Surface("plate") = {1};
Physical Curve("edge") = {1:4};
Physical Point("centre") = {1};
