%_N_PART_MPF
;expect VP0121: an earlier program may have
G17 G40 G54 G71 G90
G0 X10 Y10 Z60
G1 X=R1+2 F200
M30
