%
O0001
(G4 P 0.5 is a pause and no position)
G17 G21 G40 G49 G54 G80 G90
G0 X10. Y10. Z60.
G1 Z50. F200.
G4 P0.5
X50.
M30
%
