%_N_PART_MPF
;expect VP0208: brings in a tool whose length (D1) no word of the program names
G17 G40 G54 G71 G90
G0 X10 Y10 Z60
M6
M30
