;expect VP0223: the time is that of TMR, and X a motion
G17 G71 G90
G0 X10 Y10 Z60
G1 Z50 F200
G4 X2
M30
