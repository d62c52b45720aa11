%_N_PAno table knows M177: it passes, and a warning counts itT_MPF
;R
G17 G40 G54 G71 G90
G0 X10 Y10 Z60
G1 Z50 F200
M177
X20
G0 Z60
M30
