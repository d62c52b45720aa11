%
O0001
(expect VP0227: two transformations at once: their order depends on the control)
G17 G21 G40 G49 G54 G80 G90
G0 X10. Y10. Z60.
G51.1 X50.
G68 X0 Y0 R30.
G1 X20. Y20. F200.
G0 Z60.
M30
%
