%_N_PART_MPF
;expect VP0208: leaves the work offset for the base frame, which the profile does not have
G17 G40 G54 G71 G90
G0 X10 Y10 Z60
G500
M30
