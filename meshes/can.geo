// Half of the wall of a can without its ends, radius 0.033, height 0.06: cut along two generators.
// gmsh -2 -order 2 can.geo -o can.msh
SetFactory("Built-in");
R = 0.033; H = 0.06; n = 6; m = 5;
Point(1) = {0, 0, 0};
Point(2) = {R, 0, 0};
Point(3) = {0, R, 0};
Point(4) = {-R, 0, 0};
Circle(1) = {2, 1, 3};
Circle(2) = {3, 1, 4};
wall() = {};
out() = Extrude {0, 0, H} { Curve{1, 2}; Layers{m}; };
Transfinite Curve {1, 2} = n + 1;
Physical Surface("wall") = {out(1), out(5)};
Physical Curve("bottom") = {1, 2};
Physical Curve("top") = {out(0), out(4)};
Physical Curve("cuts") = {Abs(out(3)), Abs(out(6))};
