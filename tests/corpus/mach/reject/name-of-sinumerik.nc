%_N_PART_MPF
(expect VP0246: the name of a program on Sinumerik)
G17 G21 G40 G49 G54 G80 G90
G0 X10 Y10 Z60
G1 Z50 F200
X40
M30
