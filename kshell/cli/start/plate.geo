// A plate with a round hole.
SetFactory("Built-in");
a = 1.5; b = 1.0;              // sides
x = 1.1; y = 0.5; r = 0.2;     // the hole
h = 0.07;                      // size of triangles, half of it at the hole

Point(1) = {0, 0, 0, h};  Point(2) = {a, 0, 0, h};
Point(3) = {a, b, 0, h};  Point(4) = {0, b, 0, h};
Line(1) = {1, 2};  Line(2) = {2, 3};  Line(3) = {3, 4};  Line(4) = {4, 1};

Point(5) = {x, y, 0};
Point(6) = {x + r, y, 0, h/2};  Point(7) = {x, y + r, 0, h/2};
Point(8) = {x - r, y, 0, h/2};  Point(9) = {x, y - r, 0, h/2};
Circle(5) = {6, 5, 7};  Circle(6) = {7, 5, 8};  Circle(7) = {8, 5, 9};  Circle(8) = {9, 5, 6};

Curve Loop(1) = {1:4};  Curve Loop(2) = {5:8};
Plane Surface(1) = {1, 2};

// the names that the scene file knows
Physical Surface("plate") = {1};
Physical Curve("bottom") = {1};
Physical Curve("right") = {2};
Physical Curve("top") = {3};
Physical Curve("left") = {4};
Physical Curve("hole") = {5:8};
