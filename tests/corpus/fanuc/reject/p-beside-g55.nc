%
O0001
(expect VP0227: G55 P1 means nothing everywhere)
G17 G21 G40 G49 G54 G80 G90
G0 X10. Y10. Z60.
G55 P1
G0 Z60.
M30
%
