%
O0001
(expect VP0208: turns the rotary axes to a tilted plane)
G17 G21 G40 G49 G54 G80 G90
G0 X10. Y10. Z60.
G53.1
M30
%
