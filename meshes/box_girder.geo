// A box girder with an inner wall, half of its length: sheets that fold and branch; flat triangles.
// gmsh -2 box_girder.geo -o box_girder.msh
SetFactory("Built-in");
L = 4; b = 1; h = 0.6;
along = 10; across = 4; up = 3;       // cells
Point(1) = {0, 0, 0};   Point(2) = {0, b, 0};   Point(3) = {0, 2 * b, 0};
Point(4) = {0, 0, h};   Point(5) = {0, b, h};   Point(6) = {0, 2 * b, h};
Line(1) = {1, 2};       Line(2) = {2, 3};       // bottom
Line(3) = {4, 5};       Line(4) = {5, 6};       // top
Line(5) = {1, 4};       Line(6) = {2, 5};       Line(7) = {3, 6};   // walls
Transfinite Curve {1:4} = across + 1;
Transfinite Curve {5:7} = up + 1;
For k In {1:7}
  out[] = Extrude {L, 0, 0} { Curve{k}; Layers{along}; };
  far[k - 1] = out[0]; sheet[k - 1] = out[1];
EndFor
Coherence;
Physical Surface("plates") = {sheet[0], sheet[1], sheet[2], sheet[3]};
Physical Surface("top") = {sheet[2], sheet[3]};
Physical Surface("walls") = {sheet[4], sheet[5], sheet[6]};
Physical Curve("end") = {1:7};
Physical Curve("middle") = {far[]};
