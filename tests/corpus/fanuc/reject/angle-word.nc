%
O0001
(expect VP0142: an angle for the end of a line, by A behind a comma)
G17 G21 G40 G49 G54 G80 G90
G0 X10. Y10. Z60.
G1 Z50. F200.
G1 X40. ,A30.
M30
%
