; expect VP0224: what the called program does is in another text
N10 G17 G71 G90 G54
N20 G00 X0 Y0 Z50
(CALL 10)
N40 M30
