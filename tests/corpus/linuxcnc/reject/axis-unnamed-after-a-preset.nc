%
(expect VP0514: nobody has said where X and Y are since G92)
G17 G21 G40 G49 G54 G80 G90
G0 X10 Y10 Z60
G92 X0 Y0
G1 Z20 F200
M2
%
