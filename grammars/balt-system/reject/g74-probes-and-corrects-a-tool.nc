;expect VP0208: probes and corrects a tool
G17 G71 G90
G0 X10 Y10 Z60
G74
M30
