%
O1
(expect VP0228: nothing behind the closing percent sign is corrected, and somebody may execute it)
G17 G21 G40 G49 G54 G80 G90
G0 X10. Y10. Z60.
G1 X20. F200.
M30
%
G0 X50. Y50.
G1 Z0. F100.
