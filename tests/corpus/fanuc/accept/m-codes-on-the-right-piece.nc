%
O0001
(M3 before, M5 and M9 after the motion of their block)
G17 G21 G40 G49 G54 G80 G90
G0 X10. Y10. Z60.
M3 S1000
G1 Z50. F200. M8
G1 X400. Y400. M9
G0 Z60. M5
M30
%
