// A deck of 2 by 0.5 in squares of 0.05, each of two triangles: a wheel with sides of multiples of 0.05 fits at every step.
// gmsh -2 bridge.geo -o bridge.msh
SetFactory("Built-in");
Point(1) = {0, 0, 0};
Point(2) = {2, 0, 0};
Point(3) = {2, 0.5, 0};
Point(4) = {0, 0.5, 0};
Line(1) = {1, 2};
Line(2) = {2, 3};
Line(3) = {4, 3};
Line(4) = {1, 4};
Curve Loop(1) = {1, 2, -3, -4};
Plane Surface(1) = {1};
Transfinite Curve {1, 3} = 41;
Transfinite Curve {2, 4} = 11;
Transfinite Surface {1} Alternate;
Physical Surface("deck") = {1};
Physical Curve("abutment") = {4};
Physical Curve("bank") = {2};
