%
O0001
(expect VP0240: U and W are increments)
G17 G21 G40 G49 G54 G80 G90
G0 X62. Z2.
G1 W-30. X50. F0.25
U2. W1.
M30
%
