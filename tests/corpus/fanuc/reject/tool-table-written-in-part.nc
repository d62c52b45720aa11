%
O0001
(expect VP0215: G10 L10 writes the geometry of H7, its wear is what nobody said)
G17 G21 G40 G49 G54 G80 G90
G10 L10 P7 R120.
G0 X10. Y10. Z60.
G43 H7 Z60.
G1 Z50. F200.
M30
%
