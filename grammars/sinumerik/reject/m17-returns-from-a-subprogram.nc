%_N_PART_MPF
;expect VP0208: returns from a subprogram: the state it runs in is the caller's
G17 G40 G54 G71 G90
G0 X10 Y10 Z60
M17
M30
