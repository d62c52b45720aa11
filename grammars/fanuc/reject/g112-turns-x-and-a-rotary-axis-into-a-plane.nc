%
O0001
(expect VP0208: turns X and a rotary axis into a plane)
G17 G21 G40 G49 G54 G80 G90
G0 X10. Y10. Z60.
G112
M30
%
