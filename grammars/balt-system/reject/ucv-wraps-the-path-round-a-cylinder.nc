;expect VP0224: wraps the path round a cylinder
G17 G71 G90
G0 X10 Y10 Z60
(UCV,1)
M30
