// Names for the parts of panel.step, and sheets that share their edges where they touch.
SetFactory("OpenCASCADE");
Geometry.OCCTargetUnit = "M";          // else lengths come in millimetres
a = 3; b = 2; h = 0.15; e = 1e-3;      // what the drawing says, and a margin

Merge "panel.step";
Rectangle(100) = {1.2, 0.8, 0, 0.6, 0.4};   // where a vehicle stands, so that edges of triangles follow it
Coherence;
MeshSize{:} = 0.1;

Physical Surface("plate") = Surface In BoundingBox{-e, -e, -e, a + e, b + e, e};
Physical Surface("vehicle") = Surface In BoundingBox{1.2 - e, 0.8 - e, -e, 1.8 + e, 1.2 + e, e};
bars = {};
ends = {};
For k In {1:3}
  y = k*b/4;
  bars += Surface In BoundingBox{-e, y - e, -e, a + e, y + e, h + e};
  ends += Curve In BoundingBox{-e, y - e, -e, e, y + e, h + e};
  ends += Curve In BoundingBox{a - e, y - e, -e, a + e, y + e, h + e};
EndFor
Physical Surface("bars") = {bars()};
Physical Curve("long edges") = {Curve In BoundingBox{-e, -e, -e, a + e, e, e},
                                Curve In BoundingBox{-e, b - e, -e, a + e, b + e, e}};
Physical Curve("short edges") = {Curve In BoundingBox{-e, -e, -e, e, b + e, e},
                                 Curve In BoundingBox{a - e, -e, -e, a + e, b + e, e}};
Physical Curve("ends of bars") = {ends()};
