;expect VP0224: shifts the origin for a while
G17 G71 G90
G0 X10 Y10 Z60
(UOT,1)
M30
