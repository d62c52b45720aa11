; expect VP0217: the block is executed three times
G17 G71 G90 G54
G00 X0 Y0 Z50
G01 Z-1 F200
G91 G01 X10 N3
M30
