%_N_PART_MPF
;expect VP0146: it stands at an angle, or turns again
G17 G40 G54 G71 G90
G0 X10 Y10 Z60
S800 M3 F80
CYCLE86(45,30,3,12,,0.5,3,-0.3,0,0.2,45)
G1 X40 F200
M30
