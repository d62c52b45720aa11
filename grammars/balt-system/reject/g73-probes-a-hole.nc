;expect VP0208: probes a hole
G17 G71 G90
G0 X10 Y10 Z60
G73
M30
