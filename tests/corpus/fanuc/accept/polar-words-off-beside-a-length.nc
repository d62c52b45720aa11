%
O0001 (G15 in the block that brings in a length)
G21 G90 G17 G40 G49 G54 G80 G94
G0 X10. Y10.
G15 G43 H1 Z60.
G1 Z50. F200.
X900.
G0 Z60.
M30
%
