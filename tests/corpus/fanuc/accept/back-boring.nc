%
O0001
(G87 enters beside its hole by Q and bores upwards: the hole is corrected, shift and spindle stop are the control's)
G17 G21 G40 G49 G54 G80 G90
G0 X10. Y10. Z60.
M3 S500
G98 G87 X20. Y20. Z45. R30. Q3. P500 F100.
X60.
G80
G0 Z60.
M30
%
