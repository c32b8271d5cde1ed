// A box girder with an inner wall: sheets that meet at folds and branches.
SetFactory("Built-in");
L = 6; b = 1; h = 0.6;         // length, width of a cell, height
along = 16; across = 4; up = 3;   // cells of the mesh

Point(1) = {0, 0, 0};  Point(2) = {0, b, 0};  Point(3) = {0, 2*b, 0};
Point(4) = {0, 0, h};  Point(5) = {0, b, h};  Point(6) = {0, 2*b, h};
Line(1) = {1, 2};  Line(2) = {2, 3};                      // bottom
Line(3) = {4, 5};  Line(4) = {5, 6};                      // top
Line(5) = {1, 4};  Line(6) = {2, 5};  Line(7) = {3, 6};   // walls
Transfinite Curve {1:4} = across + 1;
Transfinite Curve {5:7} = up + 1;
For k In {1:7}
  out[] = Extrude {L, 0, 0} { Curve{k}; Layers{along}; };
  far[k - 1] = out[0];
  sheet[k - 1] = out[1];
EndFor
Coherence;

// the names that the scene file knows
Physical Surface("bottom") = {sheet[0], sheet[1]};
Physical Surface("top") = {sheet[2], sheet[3]};
Physical Surface("walls") = {sheet[4], sheet[5], sheet[6]};
Physical Curve("start") = {1:7};
Physical Curve("end") = {far[]};
