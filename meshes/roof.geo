// A quarter of a shallow cylindrical roof: radius 2540, length 508, angle 0.2; the crown is at the origin.
// gmsh -2 -order 2 roof.geo -o roof.msh
SetFactory("Built-in");
R = 2540; a = 0.1; L = 254; n = 4;
Point(1) = {0, 0, -R};
Point(2) = {0, 0, 0};
Point(3) = {R * Sin(a), 0, R * Cos(a) - R};
Point(4) = {0, L, -R};
Point(5) = {0, L, 0};
Point(6) = {R * Sin(a), L, R * Cos(a) - R};
Circle(1) = {2, 1, 3};
Circle(2) = {5, 4, 6};
Line(3) = {2, 5};
Line(4) = {3, 6};
Curve Loop(1) = {1, 4, -2, -3};
Surface(1) = {1};
Transfinite Curve {1, 2, 3, 4} = n + 1;
Transfinite Surface {1};
Physical Surface("roof") = {1};
Physical Curve("hinge") = {4};
Physical Curve("middle") = {1, 3};
Physical Point("crown") = {2};
