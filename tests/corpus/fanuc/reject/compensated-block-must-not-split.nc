%
O0001
(expect VP0503: a long compensated line that one block cannot hold)
G17 G21 G40 G49 G54 G80 G90
G0 X10. Y10. Z60.
G1 Z50. F200.
G41 D1 X20. Y10.
X900. Y800.
G40 X910. Y800.
G0 Z60.
M30
%
