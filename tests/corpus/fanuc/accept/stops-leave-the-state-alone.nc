%
O0001
(M0 and M1 stop and change nothing: what was modal before is modal after)
G17 G21 G40 G49 G54 G80 G90
G0 X10. Y10. Z60.
G1 Z50. F200.
G91 X5.
M0
Y5.
M1
X5.
G90
G0 Z60.
M30
%
