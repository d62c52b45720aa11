%
O0001
(a mirror makes of G41 what was G42, and of G2 what was G3; the words stay, so nothing may be swapped a second time)
G17 G21 G40 G49 G54 G80 G90
G0 X10. Y10. Z60.
G51.1 X100.
G0 X10. Y10.
G1 Z50. F200.
G41 D1 X20. Y10.
X24. Y14.
G3 X28. Y18. R4.
G1 X28. Y22.
G40 X20. Y22.
G50.1 X0
G0 X20. Y20. Z60.
M30
%
