;expect VP0224: shifts the origin by an increment
G17 G71 G90
G0 X10 Y10 Z60
(UIO,1)
M30
