%
O0001
(the corner lies in the plane in force, its centre words are I and K)
G17 G21 G40 G49 G54 G80 G90
G0 X10. Y10. Z60.
G18
G1 X60. F200.
Z40. ,R5.
X20. ,C3.
Z60.
G17
M30
%
