// An open box girder with an inner wall: three cells wide, sheets that branch and fold; flat triangles.
// gmsh -2 folded_box.geo -o folded_box.msh
SetFactory("OpenCASCADE");
L = 4; b = 1; h = 0.5; size = 0.18;
Rectangle(1) = {0, 0, 0, L, 2 * b};               // bottom
wall = newv;
