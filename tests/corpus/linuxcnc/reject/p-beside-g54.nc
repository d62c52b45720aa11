%
(expect VP0227: G54 P1 is another offset on other controls)
G17 G21 G40 G49 G54 G80 G90
G0 X10 Y10 Z60
G54 P1
G0 Z60
M2
%
