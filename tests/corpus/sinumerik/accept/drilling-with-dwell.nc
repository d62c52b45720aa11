%_N_PART_MPF
;CYCLE82 by the depth below the reference plane
G17 G40 G54 G71 G90
G0 X10 Y10 Z60
F200
CYCLE82(15,0,2,,10,0.5)
G0 X30
M30
