%
O0001
(expect VP0208: compensates the cutter in space)
G17 G21 G40 G49 G54 G80 G90
G0 X10. Y10. Z60.
G41.2 X20. D1 F200.
M30
%
