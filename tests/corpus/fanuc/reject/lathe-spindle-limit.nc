%
O0001
(expect VP0240: G50 S limits the spindle and G96 keeps the cutting speed)
G17 G21 G40 G49 G54 G80 G90
G50 S2000
G96 S180 M3
G0 X62. Z2.
G1 Z-30. F0.25
M30
%
