;expect VP0208: bores by a cycle whose levels are not published
G17 G71 G90
G0 X10 Y10 Z60
G85
M30
