(expect VP0227: the centre in A and B is Mach3's)
G17 G21 G40 G49 G54 G80 G90
G0 X10. Y10. Z60.
G68 A10. B10. R30.
G0 X10. Y10. Z60.
M30
