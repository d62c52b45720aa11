;expect VP0224: tilts the frame
G17 G71 G90
G0 X10 Y10 Z60
(UPR,1)
M30
