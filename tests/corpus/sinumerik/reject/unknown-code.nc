%_N_PART_MPF
;expect VP0207: a code of no table may move an axis
G17 G40 G54 G71 G90
G0 X10 Y10 Z60
G321 X20
M30
