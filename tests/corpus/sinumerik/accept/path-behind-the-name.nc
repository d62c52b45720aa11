%_N_PART_MPF
;$PATH=/_N_WKS_DIR/_N_PART_WPD
;the folder stands in the line behind the name, and nothing may come between
G17 G40 G54 G71 G90
G0 X10 Y10 Z60
G1 Z50 F200
X20
M30
