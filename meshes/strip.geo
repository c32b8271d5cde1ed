// An upright strip, 0.4 high and 0.05 wide, of triangles of two orientations.
// gmsh -2 strip.geo -o strip.msh
SetFactory("Built-in");
Point(1) = {0, 0, 0};
Point(2) = {0, 0.05, 0};
Point(3) = {0, 0.05, 0.4};
Point(4) = {0, 0, 0.4};
Line(1) = {1, 2};
Line(2) = {2, 3};
Line(3) = {4, 3};
Line(4) = {1, 4};
Curve Loop(1) = {1, 2, -3, -4};
Plane Surface(1) = {1};
Transfinite Curve {1, 3} = 3;
Transfinite Curve {2, 4} = 17;
Transfinite Surface {1} Alternate;
Physical Surface("strip") = {1};
Physical Curve("foot") = {1};
Physical Curve("head") = {3};
