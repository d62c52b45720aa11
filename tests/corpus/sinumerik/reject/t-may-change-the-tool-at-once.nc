%_N_PART_MPF
;expect VP0215: changes the tool at once where MD22550 is 0
G17 G40 G54 G71 G90
G0 X10 Y10 Z60
T2
G1 Z50 F200
M30
