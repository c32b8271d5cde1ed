// A quarter of the Scordelis-Lo roof: radius 25, length 50, half angle 40 degrees; triangles of order 2.
// gmsh -2 -order 2 scordelis_lo.geo -o scordelis_lo.msh
SetFactory("Built-in");
R = 25; L = 50; angle = 40 * Pi / 180;
n = 14; m = 3;                        // cells around and along
Point(1) = {0, 0, R};
Point(2) = {R * Sin(angle), 0, R * Cos(angle)};
Point(9) = {0, 0, 0};
Circle(1) = {1, 9, 2};
out[] = Extrude {0, L/2, 0} { Curve{1}; Layers{m}; };
Transfinite Curve {1, out[0]} = n + 1;
Transfinite Surface {out[1]} AlternateRight;
Physical Surface("roof") = {out[1]};
Physical Curve("middle") = {1};       // plane of symmetry y = 0
Physical Curve("wall") = {out[0]};
Physical Curve("crown") = {out[3]};   // plane of symmetry x = 0
Physical Curve("free") = {out[2]};
