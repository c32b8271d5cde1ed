// An eighth of the pinched cylinder: radius 300, length 600, graded towards the force; triangles of order 2.
// gmsh -2 -order 2 pinched_cylinder.geo -o pinched_cylinder.msh
SetFactory("Built-in");
R = 300; L = 600;
n = 14; grading = 1.25;
Point(1) = {0, 0, R};
Point(2) = {R, 0, 0};
Point(3) = {0, L/2, R};
Point(4) = {R, L/2, 0};
Point(8) = {0, L/2, 0};
Point(9) = {0, 0, 0};
Circle(1) = {1, 9, 2};
Line(2) = {2, 4};
Circle(3) = {3, 8, 4};
Line(4) = {1, 3};
Curve Loop(1) = {1, 2, -3, -4};
Surface(1) = {1};
Transfinite Curve {1, 2, 3, 4} = n + 1 Using Progression grading;
Transfinite Surface {1} AlternateRight;
Physical Surface("wall") = {1};
Physical Curve("middle") = {1};       // y = 0
Physical Curve("side") = {2};         // z = 0
Physical Curve("end") = {3};          // rigid diaphragm
Physical Curve("top") = {4};          // x = 0
Physical Point("force") = {1};
