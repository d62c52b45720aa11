%
O0001
(expect VP0208: calls a macro after each move)
G17 G21 G40 G49 G54 G80 G90
G0 X10. Y10. Z60.
G66 P9810 X10.
M30
%
