%
O0001
(Z is the first axis: centre words I and K)
G17 G21 G40 G49 G54 G80 G90
G0 X10. Y10. Z60.
G1 Z50. F200.
G18
G2 X30. Z50. I10. K0.
G3 X10. Z50. I-10.
G17
M30
%
