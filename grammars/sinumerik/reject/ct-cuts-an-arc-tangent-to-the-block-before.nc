%_N_PART_MPF
;expect VP0224: cuts an arc tangent to the block before
G17 G40 G54 G71 G90
G0 X10 Y10 Z60
CT
M30
