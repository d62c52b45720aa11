; after M6 an absolute rapid names every axis
G17 G21 G40 G49 G54 G80 G90
G0 X10. Y10. Z60.
G1 Z50. F200.
M5
M6 T1
G0 X10. Y10. Z60.
G1 Z50. F200.
X20.
M30
