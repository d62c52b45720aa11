%
O0001
(expect VP0213: with a bare G43 the axis moves on some controls)
G17 G21 G40 G49 G54 G80 G90
G0 X10. Y10. Z60.
G43 H1
G1 X100. F200.
M30
%
