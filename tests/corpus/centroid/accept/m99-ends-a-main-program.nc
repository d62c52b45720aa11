; M99 at the end of a main program, as CAM posts write it
G17 G21 G40 G49 G54 G80 G90
G0 X10. Y10. Z60.
G1 Z50. F200.
X20.
G0 Z60.
M99
