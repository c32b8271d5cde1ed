// The parameter plane of a zone of a sphere: u the longitude, v from the pole, graded towards the rim v = 90 degrees.
// gmsh -2 sphere_edge.geo -o sphere_edge.msh
SetFactory("Built-in");
n = 3; m = 16;
Point(1) = {0, Pi / 2, 0};
Point(2) = {Pi / 2, Pi / 2, 0};
Point(3) = {Pi / 2, Pi / 6, 0};
Point(4) = {0, Pi / 6, 0};
Line(1) = {1, 2}; Line(2) = {2, 3}; Line(3) = {4, 3}; Line(4) = {1, 4};
Curve Loop(1) = {1, 2, -3, -4};
Plane Surface(1) = {1};
Transfinite Curve {1, 3} = n + 1;
Transfinite Curve {2, 4} = m + 1 Using Progression 1.15;
Transfinite Surface {1} AlternateRight;
Physical Surface("sphere") = {1};
Physical Curve("rim") = {1};
Physical Curve("cuts") = {2, 4};
Physical Curve("far") = {3};
