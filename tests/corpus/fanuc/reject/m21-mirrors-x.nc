%
O0001
(expect VP0208: mirrors X on some machines, and is the machine builder's on others)
G17 G21 G40 G49 G54 G80 G90
G0 X10. Y10. Z60.
G1 Z50. F200.
M21
X20.
M30
%
