%
O0001
(expect VP0208: ends the mirrors of M21 and M22 on some machines, and is the machine builder's on others)
G17 G21 G40 G49 G54 G80 G90
G0 X10. Y10. Z60.
G1 Z50. F200.
M23
X20.
M30
%
