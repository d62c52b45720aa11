%_N_PART_MPF
;expect VP0214: after reset the control has G500 or what a machine datum says
G17 G40 G71 G90
G0 X10 Y10 Z60
G1 Z50 F200
M30
