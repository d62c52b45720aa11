;expect VP0224: executes a part of the program again
G17 G71 G90
G0 X10 Y10 Z60
(EPP,1)
M30
