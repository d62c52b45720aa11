%
(expect VP0246: M97 P calls a block of the same program on Haas, and is nothing here)
G17 G21 G40 G49 G54 G80 G90
G0 X10. Y10. Z60.
G1 Z50. F200.
M97 P1000
M30
N1000 G1 X40.
M99
%
