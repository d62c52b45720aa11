%
O0001
(expect VP0208: turns the work offset by a measured setting error)
G17 G21 G40 G49 G54 G80 G90
G0 X10. Y10. Z60.
G54.4 P1
M30
%
