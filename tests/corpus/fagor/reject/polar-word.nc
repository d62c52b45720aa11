; expect VP0208: Q is an angle about a pole that the block does not name
N10 G17 G71 G90 G54
N20 G00 X0 Y0 Z50
N30 G01 R30 Q45 F200
N40 M30
