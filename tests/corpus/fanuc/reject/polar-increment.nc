%
O0001
(expect VP0142: under G91 the pole is where the tool stands)
G17 G21 G40 G49 G54 G80 G90
G0 X10. Y10. Z60.
G16
G0 X20. Y30.
G91 Y30.
G90 G15
M30
%
