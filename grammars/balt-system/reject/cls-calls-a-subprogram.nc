;expect VP0224: calls a subprogram
G17 G71 G90
G0 X10 Y10 Z60
(CLS,1)
M30
