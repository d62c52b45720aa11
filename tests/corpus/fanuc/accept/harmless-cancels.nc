%
O0001
(G69 G50.1 G15 in a safe start cancel what was never on)
G17 G21 G40 G49 G54 G80 G90
G0 X10. Y10. Z60.
G15 G50.1 G69
G1 Z50. F200.
X20.
M30
%
