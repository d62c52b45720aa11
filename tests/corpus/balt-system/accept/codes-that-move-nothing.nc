;corner modes, dwell, spindle modes: no axis moves
G17 G71 G90
G0 X10 Y10 Z60
G1 Z50 F200
G4
G9 X20
G27
G96 S120
G97 S1500
(TMR=2)
X40 Y40
G0 Z60
M30
