%
(expect VP0227: G92.3 brings back what an earlier program left)
G17 G21 G40 G49 G54 G80 G90
G0 X10 Y10 Z60
G92.3
G0 Z60
M2
%
