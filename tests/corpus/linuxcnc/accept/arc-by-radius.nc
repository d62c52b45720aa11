(R near and far from 180 degrees, negative R)
G17 G21 G40 G49 G54 G80 G90
G0 X10. Y10. Z60.
G1 Z50. F200.
G2 X30. Y10. R15.
G3 X50. Y10. R-12.
G2 X69.9 Y10. R10.
M2
