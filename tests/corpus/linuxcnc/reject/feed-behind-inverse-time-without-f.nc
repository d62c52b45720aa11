(expect VP0218: the last F was an inverse time)
G17 G21 G40 G49 G54 G80 G90
G0 X10. Y10. Z60.
G1 Z50. F200.
G93 G1 X20. F2.
G94
X30.
M2
