; spindle, coolant, clamps, gears, overrides: known, and nothing is said of them
G17 G21 G40 G49 G54 G80 G90
G0 X10. Y10. Z60.
G1 Z50. F200.
M3
M4
M7
M8
M10
M11
M19
M39
M41
M42
M43
M94
M95
M100
M101
M107
M108
M109
X20.
G0 Z60.
M30
