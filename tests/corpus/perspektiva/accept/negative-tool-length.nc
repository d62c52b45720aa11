%CORPUS
(G44 subtracts the length, which is below zero here)
G17 G21 G40 G49 G54 G80 G90
G0 X10. Y10. Z60.
G44 H6 Z60.
G1 Z50. F200.
X60. Y60.
G43 H0
G0 X10. Y10. Z60.
M30
%
