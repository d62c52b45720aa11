%
O0001
(expect VP0219: an A word must not be dropped, as GRBL-Plotter's height map did, nor guessed)
G17 G21 G40 G49 G54 G80 G90
G0 X10. Y10. Z60.
G1 Z50. F200.
X20. A10.
M30
%
