%
O0001
(GOTO#1 needs the value, and the label must survive until it has been reached)
G17 G21 G40 G49 G54 G80 G90
G0 X10. Y10. Z60.
#1=20
GOTO#1
N10 G1 X99. F200.
N20 G1 X30. F200.
G0 Z60.
M30
%
