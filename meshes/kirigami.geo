// A strip 0.3 by 0.1 with rows of slits, which open and twist when it is pulled.
// gmsh -2 kirigami.geo -o kirigami.msh
SetFactory("Built-in");
h = 0.0125;
Point(1) = {0, 0, 0, h};
Point(2) = {0.3, 0, 0, h};
Point(3) = {0.3, 0.1, 0, h};
Point(4) = {0, 0.1, 0, h};
Line(1) = {1, 2};
Line(2) = {2, 3};
Line(3) = {3, 4};
Line(4) = {4, 1};
Curve Loop(1) = {1:4};
Plane Surface(1) = {1};
// every second row has one slit in the middle, the others reach in from both edges' sides
slit() = {};
For row In {1:9}
  x = 0.03 * row;
  p = newp;
  If (row % 2 == 1)
    Point(p) = {x, 0.02, 0, h};
    Point(p + 1) = {x, 0.08, 0, h};
    l = newl;
    Line(l) = {p, p + 1};
    slit() += {l};
  Else
    Point(p) = {x, 0.005, 0, h};
    Point(p + 1) = {x, 0.04, 0, h};
    Point(p + 2) = {x, 0.06, 0, h};
    Point(p + 3) = {x, 0.095, 0, h};
    l = newl;
    Line(l) = {p, p + 1};
    Line(l + 1) = {p + 2, p + 3};
    slit() += {l, l + 1};
  EndIf
EndFor
Curve{slit()} In Surface{1};

Physical Surface("sheet") = {1};
Physical Curve("left") = {4};
Physical Curve("right") = {2};
Physical Curve("slits") = {slit()};
