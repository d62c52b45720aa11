%
O0001
(expect VP0227: G92 with a length in force: a parameter decides)
G17 G21 G40 G49 G54 G80 G90
G0 X10. Y10. Z60.
G43 H1 Z60.
G92 Z0
G0 Z60.
M30
%
