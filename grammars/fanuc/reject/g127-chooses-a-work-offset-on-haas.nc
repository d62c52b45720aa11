%
O0001
(expect VP0208: a work offset on Haas, nothing on Fanuc)
G17 G21 G40 G49 G54 G80 G90
G0 X10. Y10. Z60.
G127
G1 Z50. F200.
M30
%
