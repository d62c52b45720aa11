(words beside M66 and M101 are theirs; ioSender's height map dropped the whole command)
G17 G21 G40 G49 G54 G80 G90
G0 X10. Y10. Z60.
G1 Z50. F200.
M66 P0 L0
X20.
M101 P60 Q2
X40.
G0 Z60.
M2
