%_N_PART_MPF
;expect VP0224: suppresses frames and offsets for its block
G17 G40 G54 G71 G90
G0 X10 Y10 Z60
SUPA
M30
