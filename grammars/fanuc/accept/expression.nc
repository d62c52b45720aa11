%
O0001
(executed and expanded)
G17 G21 G40 G49 G54 G80 G90
G0 X10. Y10. Z60.
G1 X[1+2] F200.
M30
%
