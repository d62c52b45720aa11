;what stands behind M2 is not executed
G17 G71 G90
G0 X10 Y10 Z60
G1 Z50 F200
X20
G0 Z60
M2
;after the end
