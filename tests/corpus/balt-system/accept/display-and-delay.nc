;(DIS) and (DLY) move nothing and keep their brackets
G17 G71 G90
G0 X10 Y10 Z60
(DIS,"part X1")
G1 Z50 F200
(DLY,2)
X20
M30
