%
O0001
(expect VP0208: turns polygons with two spindles)
G17 G21 G40 G49 G54 G80 G90
G0 X10. Y10. Z60.
G51.2 P1 Q2
M30
%
