%_N_PART_MPF
;expect VP0146: in force are 200 of the program or 250 of the cycle
G17 G40 G54 G71 G90
G0 X10 Y10 Z60
F200
CYCLE85(45,30,3,,18,0.4,60,250)
G1 Z20
M30
