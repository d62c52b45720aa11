%
O0001
(G20: model in mm, output in inches)
G17 G21 G40 G49 G54 G80 G90
G0 X10. Y10. Z60.
G20
G0 X1. Y1. Z2.5
G1 Z2. F10.
X3.5 Y2.25
M30
%
