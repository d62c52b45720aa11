%
O0001
(expect VP0208: takes the tool along a tilted axis)
G17 G21 G40 G49 G54 G80 G90
G0 X10. Y10. Z60.
G43.1 H1
M30
%
