(stored places, path modes, spindle modes: no axis moves, and G28.1 is no return; sheet scripts that match G28 as a prefix homed here)
G17 G21 G40 G49 G54 G80 G90
G0 X10. Y10. Z60.
G1 Z50. F200.
G8
G28.1
X20.
G30.1
G61.1
X30.
G64 P0.01
M70
M71
G96 D2500 S120
G97 S1500
X40. Y40.
G0 Z60.
M2
