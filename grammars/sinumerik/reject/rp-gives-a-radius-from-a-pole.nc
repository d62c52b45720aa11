%_N_PART_MPF
;expect VP0224: gives a radius from a pole
G17 G40 G54 G71 G90
G0 X10 Y10 Z60
RP
M30
