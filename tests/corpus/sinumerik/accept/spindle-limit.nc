%_N_PAa limit of the spindle, and radii: no axis movesT_MPF
;R
G17 G40 G54 G71 G90
G0 X10 Y10 Z60
DIAMOF
LIMS=2500
G1 Z50 F200
X20 Y20
M30
