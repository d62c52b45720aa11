%_N_PART_MPF
;expect VP0208: moves axes to a fixed point, named as X1=0
G17 G40 G54 G71 G90
G0 X10 Y10 Z60
G75
M30
