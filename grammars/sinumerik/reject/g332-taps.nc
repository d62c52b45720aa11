%_N_PART_MPF
;expect VP0208: taps in step with the spindle
G17 G40 G54 G71 G90
G0 X10 Y10 Z60
G332
M30
