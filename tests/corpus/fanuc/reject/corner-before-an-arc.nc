%
O0001
(expect VP0142: tangent to an arc: two solutions)
G17 G21 G40 G49 G54 G80 G90
G0 X10. Y10. Z60.
G1 Z50. F200.
X40. ,R5.
G2 X60. Y30. R20.
M30
%
