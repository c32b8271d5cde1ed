// A roof of free form over a rectangle: two edges lie on walls, between them it is spanned by two unlike arches.
SetFactory("Built-in");
a = 12; b = 10;                // plan
low = 1.5; high = 3;           // rise of the two arches
h = 0.8;                       // size of triangles

Point(1) = {0, 0, 0, h};  Point(2) = {a, 0, 0, h};
Point(3) = {a, b, 0, h};  Point(4) = {0, b, 0, h};
Point(5) = {a/4, 0, 0.75*low, h};  Point(6) = {a/2, 0, low, h};  Point(7) = {3*a/4, 0, 0.75*low, h};
Point(8) = {3*a/4, b, 0.75*high, h};  Point(9) = {a/2, b, high, h};  Point(10) = {a/4, b, 0.75*high, h};
Spline(1) = {1, 5, 6, 7, 2};
Line(2) = {2, 3};
Spline(3) = {3, 8, 9, 10, 4};
Line(4) = {4, 1};
Curve Loop(1) = {1:4};
Surface(1) = {1};              // between its four edges

// the names that the scene file knows
Physical Surface("roof") = {1};
Physical Curve("walls") = {2, 4};
Physical Curve("low arch") = {1};
Physical Curve("high arch") = {3};
