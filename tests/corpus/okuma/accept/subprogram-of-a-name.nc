OMAIN (a subprogram that has a name, in the same file)
G15 H1
G0 G17 G21 G40 G53 G80 G90 X10. Y10. Z60.
G1 Z50. F200.
CALL OSLOT Q2
G0 Z60.
M2
OSLOT (along X, and on to the next)
G91
X25.
Y6.
X-25.
Y6.
G90
RTS
