%
O0001
(expect VP0230: moves the axes so that the tool's tip follows the path, tool centre point)
G17 G21 G40 G49 G54 G80 G90
G0 X10. Y10. Z60.
G234 H1
M30
%
