%
(words of 0.01 mm: the radii at start and end differ by 0.02 mm, and the control cuts a spiral)
G17 G21 G40 G49 G54 G80 G90
G0 X30 Y20 Z60
G1 Z50 F200
G3 X21.34 Y35.02 I-8.66 J5
G1 X40
M2
%
