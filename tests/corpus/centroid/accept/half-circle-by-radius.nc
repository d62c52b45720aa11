; R is half the chord: micrometres of correction make it impossible or flip it, where an output keeps R; senders failed here with no such arc
G17 G21 G40 G49 G54 G80 G90
G0 X10. Y10. Z60.
G1 Z50. F200.
G2 X30. Y10. R10.
G3 X10. Y10. R-10.
G2 X10.001 Y29.9 R10.
G0 Z60.
M30
