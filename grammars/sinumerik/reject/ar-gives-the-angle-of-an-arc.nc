%_N_PART_MPF
;expect VP0224: gives the angle of an arc
G17 G40 G54 G71 G90
G0 X10 Y10 Z60
AR
M30
