%CORPUS
(acceleration, exactness, spindle modes: no axis moves; tools that know only G0 to G3 stopped or dropped the line)
G17 G21 G40 G49 G54 G80 G90
G0 X10. Y10. Z60.
G1 Z50. F200.
G8 X20.
G9 X30.
G60
G61
G62
G64
G67
G92.1
G96 S120
G97 S1500
X40. Y40.
G0 Z60.
M30
%
