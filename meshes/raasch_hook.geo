// The Raasch hook: two arcs of radius 14 (60 degrees) and 46 (150 degrees), bent oppositely, 20 wide; order 2.
// gmsh -2 -order 2 raasch_hook.geo -o raasch_hook.msh
SetFactory("Built-in");
r = 14; R = 46; width = 20;
a = Pi / 3; b = 5 * Pi / 6;
x = (r + R) * Sin(a); z = r - (r + R) * Cos(a);   // centre of the large arc
Point(1) = {0, 0, 0};
Point(2) = {r * Sin(a), 0, r - r * Cos(a)};
Point(3) = {x - R * Sin(a - Pi / 2), 0, z + R * Cos(a - Pi / 2)};
Point(4) = {x + R * Sin(b - a), 0, z + R * Cos(b - a)};
Point(8) = {0, 0, r};
Point(9) = {x, 0, z};
Circle(1) = {1, 8, 2};
Circle(2) = {2, 9, 4};
first[] = Extrude {0, width, 0} { Curve{1}; Layers{2}; };
second[] = Extrude {0, width, 0} { Curve{2}; Layers{2}; };
Transfinite Curve {1, first[0]} = 4 + 1;
Transfinite Curve {2, second[0]} = 16 + 1;
Transfinite Surface {first[1], second[1]} AlternateRight;
Physical Surface("hook") = {first[1], second[1]};
Physical Curve("root") = {first[3]};
Physical Curve("tip") = {second[2]};
