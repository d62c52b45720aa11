%_N_PART_MPF
;expect VP0224: cuts the corner to the next block
G17 G40 G54 G71 G90
G0 X10 Y10 Z60
CHF
M30
