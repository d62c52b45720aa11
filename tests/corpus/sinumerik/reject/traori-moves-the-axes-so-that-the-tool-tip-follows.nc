%_N_PART_MPF
;expect VP0230: moves the axes so that the tool's tip follows the path
G17 G40 G54 G71 G90
G0 X10 Y10 Z60
TRAORI
M30
