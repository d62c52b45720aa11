%
(cubic and quadratic curves, the second cubic going on from the first; a NURBS as in the manual)
G17 G21 G40 G49 G54 G80 G90
M3 S1000
G0 X10 Y10 Z60
G1 Z50 F200
G5 I0 J30 P0 Q-30 X20 Y20
G5 P10 Q-20 X30 Y30
G5.1 I10 J10 X45 Y35 (quadratic)
N100 G5.2 X50 Y45 P1 L3
N110 X70 Y65 P2 F150
M8
(the last two)
X70 Y45 P0.5
X50 Y35 P1
G5.3
G1 X55 Y35
G0 Z60
M2
%
