%_N_PART_MPF
;CYCLE86: the spindle stands at 45 degrees, the tool leaves the wall by 0.3
G17 G40 G54 G71 G90
G0 X20 Y15 Z60
S800 M3 F80
CYCLE86(45,30,3,12,,0.5,3,-0.3,0,0.2,45)
G0 X80
M3
G1 Z20 F150
M30
