%
O0001
(expect VP0218: no control feeds a cycle by inverse time)
G17 G21 G40 G49 G54 G80 G90
G0 X10. Y10. Z60.
G93
G81 X1. Y1. Z30. R55. F100.
G0 Z60.
M30
%
