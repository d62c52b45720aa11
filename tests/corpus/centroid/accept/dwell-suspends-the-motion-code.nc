; after G4 the G1 before it is in force again
G17 G21 G40 G49 G54 G80 G90
G0 X10. Y10. Z60.
G1 Z50. F200.
X40.
G4 P0.1
X10.
M30
