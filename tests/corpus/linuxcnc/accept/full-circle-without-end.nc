(G2 I-5.25: start and end are one point)
G17 G21 G40 G49 G54 G80 G90
G0 X10. Y10. Z60.
G1 Z50. F200.
G1 X30.
G2 I-5.25
G3 I-5.25 J0.
M2
