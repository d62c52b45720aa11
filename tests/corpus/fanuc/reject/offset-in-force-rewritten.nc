%
O0001
(expect VP0227: G10 writes the offset in force: at once or not?)
G17 G21 G40 G49 G54 G80 G90
G0 X10. Y10. Z60.
G10 L2 P1 X5. Y5. Z5.
G1 X20. Y20. F200.
G0 Z60.
M30
%
