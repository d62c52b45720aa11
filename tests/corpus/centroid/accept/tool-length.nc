; G43 H1: the axis stands higher by the length, and the errors are those of that height; levellers look them up at the program's Z
G17 G21 G40 G49 G54 G80 G90
G0 X10. Y10. Z60.
G43 H1 Z60.
G1 Z50. F200.
X60. Y60.
G49
G0 X10. Y10. Z60.
M30
