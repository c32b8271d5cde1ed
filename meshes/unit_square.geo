// Unit square, with all its edges together as "edge" beside each by itself.
// gmsh -2 unit_square.geo -o unit_square.msh
SetFactory("Built-in");
h = 0.1;
Point(1) = {0, 0, 0, h};
Point(2) = {1, 0, 0, h};
Point(3) = {1, 1, 0, h};
Point(4) = {0, 1, 0, h};
Line(1) = {1, 2};
Line(2) = {2, 3};
Line(3) = {3, 4};
Line(4) = {4, 1};
Curve Loop(1) = {1:4};
Plane Surface(1) = {1};
Point(5) = {0.5, 0.5, 0, h};
Point{5} In Surface{1};

Physical Surface("plate") = {1};
Physical Curve("bottom") = {1};
Physical Curve("right") = {2};
Physical Curve("top") = {3};
Physical Curve("left") = {4};
Physical Curve("edge") = {1:4};
Physical Point("corner") = {3};
Physical Point("centre") = {5};
