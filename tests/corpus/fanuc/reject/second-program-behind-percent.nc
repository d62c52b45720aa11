%
O0001
(expect VP0228: a second program after the end of the first stays uncorrected in every tool that stops at M30)
G17 G21 G40 G49 G54 G80 G90
G0 X10. Y10. Z60.
G1 X20. F200.
M30
%
O0002
G0 X50. Y50.
G1 Z0. F100.
M30
%
O3
G0 Z60.
M30
%
