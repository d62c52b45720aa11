%
(expect VP0213: G92 after a reference return)
G17 G21 G40 G49 G54 G80 G90
G0 X10 Y10 Z60
G28 X10
G92 X0
G0 Z60
M2
%
