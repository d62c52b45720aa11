%
O0001
(expect VP0142: the radius of a place that G16 has not named)
G17 G21 G40 G49 G54 G80 G90
G0 X10. Y10. Z60.
G16
G0 Y30.
G15
M30
%
