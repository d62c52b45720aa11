;expect VP0208: cuts an arc whose centre is read differently under G90 and G91
G17 G71 G90
G0 X10 Y10 Z60
G3
M30
