%_N_PART_MPF
;text in a command is no word
G17 G40 G54 G71 G90
G0 X10 Y10 Z60
MSG("part X1 (left)")
G1 Z50 F200
X20
MSG()
M30
