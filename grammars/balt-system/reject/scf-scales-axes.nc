;expect VP0224: scales axes
G17 G71 G90
G0 X10 Y10 Z60
(SCF,1)
M30
