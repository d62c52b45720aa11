%
O0001
(expect VP0208: the end of G41.1 on Fanuc, a pocket on Haas)
G17 G21 G40 G49 G54 G80 G90
G0 X10. Y10. Z60.
G150 P2 X20. Y20. Z-3. R2. Q1. K2. F200.
M30
%
