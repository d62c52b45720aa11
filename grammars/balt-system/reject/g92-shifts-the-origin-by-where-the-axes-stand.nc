;expect VP0208: shifts the origin by where the axes stand
G17 G71 G90
G0 X10 Y10 Z60
G92
M30
