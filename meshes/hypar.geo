// Half of the partly clamped hyperbolic paraboloid z = x^2 - y^2 over the unit square; triangles of order 2.
// gmsh -2 -order 2 hypar.geo -o hypar.msh
SetFactory("Built-in");
n = 20; m = 10;
// A parabola is a Bezier curve of degree 2, the surface the bilinear blend of four of them
Point(1) = {-0.5, 0, 0.25};
Point(2) = {0.5, 0, 0.25};
Point(3) = {0.5, 0.5, 0};
Point(4) = {-0.5, 0.5, 0};
Point(5) = {0, 0, -0.25};
Point(6) = {0.5, 0.25, 0.25};
Point(7) = {0, 0.5, -0.5};
Point(8) = {-0.5, 0.25, 0.25};
Bezier(1) = {1, 5, 2};
Bezier(2) = {2, 6, 3};
Bezier(3) = {4, 7, 3};
Bezier(4) = {1, 8, 4};
Curve Loop(1) = {1, 2, -3, -4};
Surface(1) = {1};
Transfinite Curve {1, 3} = n + 1 Using Bump 0.3;
Transfinite Curve {2, 4} = m + 1;
Transfinite Surface {1} AlternateRight;
Physical Surface("shell") = {1};
Physical Curve("y = 0") = {1};
Physical Curve("free") = {2, 3};
Physical Curve("clamped") = {4};
