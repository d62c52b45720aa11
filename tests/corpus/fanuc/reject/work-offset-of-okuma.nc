%
O0001
(expect VP0246: G15 H1 and G56 H2 are a work offset and a tool length of Okuma)
G17 G21 G40 G49 G80 G90
G15 H1
G0 X10. Y10. Z60.
G56 H2
G1 Z50. F200.
M30
%
