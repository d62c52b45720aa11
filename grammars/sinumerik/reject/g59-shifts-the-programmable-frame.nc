%_N_PART_MPF
;expect VP0208: shifts the programmable frame
G17 G40 G54 G71 G90
G0 X10 Y10 Z60
G59
M30
