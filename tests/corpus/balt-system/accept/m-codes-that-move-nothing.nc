;spindle, coolant, clamps, gears, overrides: known, and nothing is said of them
G17 G71 G90
G0 X10 Y10 Z60
G1 Z50 F200
M3
M4
M7
M8
M10
M11
M13
M14
M19
M40
M41
M42
M43
M44
M45
X20
G0 Z60
M30
