; expect VP0224: a remark on the 8065, a sentence on the 8055
N10 G17 G71 G90 G54
(FINISH THE SIDE)
N20 G00 X0 Y0 Z50
N30 M30
