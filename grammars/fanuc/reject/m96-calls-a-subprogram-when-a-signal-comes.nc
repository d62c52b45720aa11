%
O0001
(expect VP0208: calls a subprogram when a signal comes)
G17 G21 G40 G49 G54 G80 G90
G0 X10. Y10. Z60.
M96 P1000
M30
%
