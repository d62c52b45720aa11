%
O0001
(expect VP0240: G50 with X and Z, and never the third axis)
G21 G40
G50 X200. Z100.
G0 X62. Z2.
G1 Z-30. F0.25
M30
%
