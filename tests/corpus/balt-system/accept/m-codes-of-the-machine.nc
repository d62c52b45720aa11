;M codes without a row switch things and pass
G17 G71 G90
G0 X10 Y10 Z60
M8
G1 Z50 F200
M130
X20
M9
G0 Z60
M30
