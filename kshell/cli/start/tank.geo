// The wall of a round tank that stands upright.
SetFactory("Built-in");
R = 5; H = 6;                  // radius and height
around = 12;                   // cells of a quarter

Point(1) = {0, 0, 0};
Point(2) = {R, 0, 0};  Point(3) = {0, R, 0};  Point(4) = {-R, 0, 0};  Point(5) = {0, -R, 0};
Circle(1) = {2, 1, 3};  Circle(2) = {3, 1, 4};  Circle(3) = {4, 1, 5};  Circle(4) = {5, 1, 2};
Transfinite Curve {1:4} = around + 1;
For k In {1:4}
  // eight cells up to a fifth of the height, where the wall bends, eight above
  wall[] = Extrude {0, 0, H} { Curve{k}; Layers{ {8, 8}, {0.2, 1} }; };
  rim[k - 1] = wall[0];
  sheet[k - 1] = wall[1];
EndFor

// the names that the scene file knows
Physical Surface("wall") = {sheet[]};
Physical Curve("base") = {1:4};
Physical Curve("rim") = {rim[]};
