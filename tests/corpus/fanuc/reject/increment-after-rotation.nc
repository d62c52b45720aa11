%
O0001
(expect VP0227: an increment from a place that G68 has not told)
G17 G21 G40 G49 G54 G80 G90
G0 X10. Y10. Z60.
G68 X0 Y0 R30.
G91 G1 X20. Y20. F200.
G0 Z60.
M30
%
