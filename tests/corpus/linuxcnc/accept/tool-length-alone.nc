(G43 H1 in a block of its own moves nothing: Z stands where it stood, and the next word leads 120 higher)
G17 G21 G40 G49 G54 G80 G90
G0 X10. Y10. Z60.
G43 H1
G1 Z50. F200.
X60. Y60.
G49
G1 Z60.
G0 X10. Y10. Z60.
M2
