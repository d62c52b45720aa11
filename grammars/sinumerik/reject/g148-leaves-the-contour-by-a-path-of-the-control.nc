%_N_PART_MPF
;expect VP0208: leaves the contour by a path of the control
G17 G40 G54 G71 G90
G0 X10 Y10 Z60
G148
M30
