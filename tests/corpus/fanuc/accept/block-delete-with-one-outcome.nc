%
O0001
(a skipped comment or M8 changes no state)
G17 G21 G40 G49 G54 G80 G90
G0 X10. Y10. Z60.
/M8
G1 Z50. F200.
X20.
/(remark)
M30
%
