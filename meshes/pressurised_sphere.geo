// An eighth of a sphere of radius 1; triangles of order 2.
// gmsh -2 -order 2 pressurised_sphere.geo -o pressurised_sphere.msh
SetFactory("Built-in");
R = 1; h = 0.16;
Point(1) = {R, 0, 0, h};
Point(2) = {0, R, 0, h};
Point(3) = {0, 0, R, h};
Point(9) = {0, 0, 0};
Circle(1) = {1, 9, 2};
Circle(2) = {2, 9, 3};
Circle(3) = {3, 9, 1};
Curve Loop(1) = {1, 2, 3};
Surface(1) = {1} In Sphere {9};
Physical Surface("sphere") = {1};
Physical Curve("cuts") = {1:3};
