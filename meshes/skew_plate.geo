// Skew plate, a rhombus of side 1 with an acute angle of 30 degrees; finer at the obtuse corners.
// gmsh -2 skew_plate.geo -o skew_plate.msh
SetFactory("Built-in");
angle = 30 * Pi / 180;
c = Cos(angle); s = Sin(angle);
h = 0.06;
Point(1) = {0, 0, 0, h};
Point(2) = {1, 0, 0, h/2};
Point(3) = {1 + c, s, 0, h};
Point(4) = {c, s, 0, h/2};
Line(1) = {1, 2};
Line(2) = {2, 3};
Line(3) = {3, 4};
Line(4) = {4, 1};
Curve Loop(1) = {1:4};
Plane Surface(1) = {1};
Point(5) = {(1 + c)/2, s/2, 0, h};
Point{5} In Surface{1};

Physical Surface("plate") = {1};
Physical Curve("bottom") = {1};
Physical Curve("right") = {2};
Physical Curve("top") = {3};
Physical Curve("left") = {4};
Physical Curve("edge") = {1:4};
Physical Point("centre") = {5};
