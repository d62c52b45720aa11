%CORPUS
(expect VP0240: T0101 and never the third axis)
G21 G40
T0101
G0 X62. Z2.
G1 Z-30. F0.25
M30
%
