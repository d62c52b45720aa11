%
(spindle, coolant, clamps, gears, overrides: known, and nothing is said of them)
G17 G21 G40 G49 G54 G80 G90
G0 X10. Y10. Z60.
G1 Z50. F200.
M3
M4
M7
M8
M19
M48
M49
M50
M51
M52
M53
M62
M63
M64
M65
M67
M68
M70
M71
X20.
G0 Z60.
M2
%
