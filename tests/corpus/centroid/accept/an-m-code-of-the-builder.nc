; no table knows M177: it passes, and a warning counts it
G17 G21 G40 G49 G54 G80 G90
G0 X10. Y10. Z60.
G1 Z50. F200.
M177
X20.
G0 Z60.
M30
