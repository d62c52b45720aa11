%_N_PART_MPF
;expect VP0120: the flat program sets no R1
G17 G40 G54 G71 G90
G0 X10 Y10 Z60
R1=90
SPOS=R1
M30
