%
O0001
(expect VP0208: the end of G112 on Fanuc, a work offset on Haas)
G17 G21 G40 G49 G54 G80 G90
G0 X10. Y10. Z60.
G113
G1 Z50. F200.
M30
%
