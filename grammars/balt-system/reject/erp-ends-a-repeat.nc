;expect VP0224: ends a repeat that another file began
G17 G71 G90
G0 X10 Y10 Z60
(ERP)
M30
