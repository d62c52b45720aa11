%_N_PART_MPF
;expect VP0208: sets a pole: what follows is radius and angle
G17 G40 G54 G71 G90
G0 X10 Y10 Z60
G112
M30
