;expect VP0208: brings in a tool length that no word of the program names
G17 G71 G90
G0 X10 Y10 Z60
M6
M30
