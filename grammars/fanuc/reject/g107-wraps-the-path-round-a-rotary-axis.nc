%
O0001
(expect VP0208: wraps the path round a rotary axis)
G17 G21 G40 G49 G54 G80 G90
G0 X10. Y10. Z60.
G107 C30.
M30
%
