%
O0001
(look-ahead, limits, checks, spindle modes: no axis moves; tools that read X as X wherever it stands moved here)
G17 G21 G40 G49 G54 G80 G90
G0 X10. Y10. Z60.
G1 Z50. F200.
G5.4 Q1
X20.
G8 P1
G9 X30.
G61
G62
G63
G64
X35.
G11
G13.1
G22 X900. Y900. Z900. I-10. J-10. K-10.
G23
G25
G26 P100 Q10 R5
G40.1
G50.2
G67
G69.1
G255
G103 P1
G96 S120
G97 S1500
X40. Y40.
G0 Z60.
M30
%
