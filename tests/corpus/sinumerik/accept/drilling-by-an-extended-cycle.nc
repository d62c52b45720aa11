%_N_PART_MPF
;arguments of an extended cycle that choose nothing
G17 G40 G54 G71 G90
G0 X10 Y10 Z60
F200
MCALL CYCLE81(15, 0, 2, -10.5, , 0, 0, 10)
X20 Y20
Y35.5
X40
Y20
X60
MCALL
G0 Z60
M30
