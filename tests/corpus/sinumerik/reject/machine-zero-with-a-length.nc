%_N_PART_MPF
;expect VP0215: of the tip, or of the spindle
G17 G40 G54 G71 G90
T1
M6
D1
G0 SUPA Z0
M30
