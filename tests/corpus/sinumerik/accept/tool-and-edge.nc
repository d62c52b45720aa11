%_N_PART_MPF
;M6 brings in what T selects, D1 its length; the next T selects
G17 G40 G54 G71 G90
T1
M6
D1
G0 X10 Y10 Z60
T2
G1 Z50 F200
X60
G0 Z80
M6
D1
G0 X10 Y10 Z60
G1 Z50
X60
M30
