// The twisted beam: length 12, width 1.1, turned by 90 degrees; triangles of order 2 on the parameter plane of
// the helicoid (u cos v, u sin v, c v) with c = 12 / (pi / 2), so that the beam runs along z.
// gmsh -2 twisted_beam.geo -o twisted_beam.msh
SetFactory("Built-in");
n = 24; m = 4;
Point(1) = {-0.55, 0, 0};
Point(2) = {0.55, 0, 0};
Point(3) = {0.55, Pi / 2, 0};
Point(4) = {-0.55, Pi / 2, 0};
Line(1) = {1, 2}; Line(2) = {2, 3}; Line(3) = {4, 3}; Line(4) = {1, 4};
Curve Loop(1) = {1, 2, -3, -4};
Plane Surface(1) = {1};
Transfinite Curve {1, 3} = m + 1;
Transfinite Curve {2, 4} = n + 1;
Transfinite Surface {1} AlternateRight;
Physical Surface("beam") = {1};
Physical Curve("root") = {1};
Physical Curve("tip") = {3};
Physical Curve("edges") = {2, 4};
